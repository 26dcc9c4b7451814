"""Do two arenas rank alike? ``python reports/rank_correlation.py A B``, two run directories (or folders with an ``arena.csv``).

For each place the shares of the methods that both have, Spearman's rho and Kendall's tau-b (which count equal shares as level), by scipy;
beside them how many methods there are. Flown with other seeds, the two share nothing but the methods and the kinds of encounters:

    testbed run campaigns/arena.yaml --set seed=7 --out reports/runs/arena-7
    python reports/rank_correlation.py reports/runs/arena reports/runs/arena-7
"""

import argparse
import csv
import math
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path

from scipy import stats

Place = tuple[str, str]
Shares = dict[Place, dict[str, float]]


def shares(folder: Path) -> Shares:
    """Place to method to its share at its own best lead, the control apart."""
    found: Shares = {}
    with (folder / "arena.csv").open(newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            if line["table"] == "best" and line["rank"]:
                found.setdefault((line["rung"], line["flown_by"]), {})[line["method"]] = float(line["share"])
    return found


def correlation(first: Mapping[str, float], second: Mapping[str, float]) -> tuple[int, float, float]:
    """Methods of both, Spearman's rho, Kendall's tau-b; NaN where one of the two has all level, or there are fewer than three."""
    both = [method for method in first if method in second]
    if len(both) < 3:
        return len(both), math.nan, math.nan
    a, b = ([of[method] for method in both] for of in (first, second))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", stats.ConstantInputWarning)
        return len(both), float(stats.spearmanr(a, b).statistic), float(stats.kendalltau(a, b).statistic)


def main() -> int:
    """Compare the two that the command line names."""
    parser = argparse.ArgumentParser(prog="rank_correlation", description="Do two arenas rank the methods alike?")
    parser.add_argument("first", metavar="A", type=Path, help="a run directory with an arena.csv")
    parser.add_argument("second", metavar="B", type=Path, help="another one")
    asked = parser.parse_args()
    try:
        first, second = shares(asked.first), shares(asked.second)
    except (OSError, KeyError, ValueError) as problem:
        print(f"cannot be compared: {problem}", file=sys.stderr)
        return 2
    print(f"{'place':<24}{'methods':>8}{'Spearman':>10}{'Kendall':>9}")
    for place in first:
        if place in second:
            n, rho, tau = correlation(first[place], second[place])
            print(f"{' '.join(filter(None, place)):<24}{n:>8}{rho:>10.2f}{tau:>9.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
