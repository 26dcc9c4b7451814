"""The verdict on the paper as the leading part of a campaign's page: table, sentences, pictures, and the tables behind them."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from testbed.show import words
from testbed.show.assets import PageHead, asset, environment, packed_json
from testbed.show.gathered import Row
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW, Waterfall
from testbed.studies.scoam.page import bars, detail, moving, paper_names, picture_data, readings, table, top
from testbed.studies.scoam.page.quotable import paragraphs

if TYPE_CHECKING:
    from testbed.studies.scoam.verdict.judged import Verdict

MEANING = {
    HOLDS: "shown for the point and for the aircraft, in every condition that was flown",
    HOLDS_ONLY_IF: "shown under the condition that is named, and not otherwise",
    FAILS_KINEMATICALLY: "false already for a point that flies the path exactly; flight dynamics is not to blame",
    FAILS_WHEN_FLOWN: "true of the point, false of an aircraft that has to fly it",
    NOT_DETERMINED: "it depends on what the paper does not print, or was not flown",
    TOO_FEW: "withheld: so few flights or draws do not settle it",
}


def render(verdict: "Verdict", rows: Sequence[Row], series: Mapping[str, dict[str, Any] | None]) -> PageHead:
    """The leading part of the page. ``rows`` as in rows.jsonl, ``series`` by flight id; whatever is missing is left out."""
    data = picture_data.picture_data(rows, series)
    parts = {
        "groups": table.groups(verdict.claims),
        "meaning": [(word, paper_names.WORD_CLASS[word], text) for word, text in MEANING.items()],
        "paragraphs": paragraphs(verdict),
        "falls": _pictured(verdict.waterfalls),
        "rankings": _rankings(verdict),
        "panels": [(key, panel["name"]) for key, panel in sorted(data["aircraft"].items(), key=_by_name)],
        "listed": picture_data.flight_list(rows),
        "controls": detail.control_rows(verdict.controls),
        "ranks": detail.rank_groups(verdict.ranks),
        "air": detail.air_tables(verdict.air),
        "waterfalls": detail.waterfall_table(verdict.waterfalls),
        "cases": detail.case_table(verdict.cases),
        "readings": readings.reading_rows(verdict),
        "reading_table": readings.reading_table(verdict.reading_cells),
    }
    html = environment(__name__).get_template("verdict.html.j2").render(**parts, data=packed_json(data) if data["aircraft"] else "")
    sections = (
        ("verdict", "Verdict", parts["groups"]),
        ("verdict-words", "Summary", parts["paragraphs"]),
        ("verdict-pictures", "Steps", parts["panels"] or parts["falls"]),
        ("verdict-methods", "Methods", parts["ranks"]),
        ("verdict-readings", "Readings", parts["readings"]),
        ("verdict-air", "Wind", parts["air"]),
        ("verdict-controls", "Controls", parts["controls"]),
    )
    nav = tuple((anchor, name) for anchor, name, there in sections if there)
    return PageHead(
        Markup(html),
        asset("verdict.css", __name__),
        asset("verdict.js", __name__),
        nav,
        moving.scenes(rows, series),
        hero=top.hero(verdict),
        names=paper_names.LABEL_NAMES,
    )


def _by_name(item: tuple[str, dict[str, Any]]) -> tuple[bool, str]:
    """The paper's geometry first."""
    return item[0] not in paper_names.AIRCRAFT_NAMES, str(
        list(paper_names.AIRCRAFT_NAMES).index(item[0]) if item[0] in paper_names.AIRCRAFT_NAMES else item[0]
    )


def _pictured(falls: Sequence[Waterfall]) -> list[dict[str, Any]]:
    """The waterfalls of the verdict's own encounter, one an aircraft."""
    mine = [fall for fall in falls if (fall.encounter, fall.method) == (paper_names.ENCOUNTER, paper_names.METHOD) and fall.steps]
    return [{"title": words.named(paper_names.AIRCRAFT_NAMES, fall.aircraft), "svg": bars.waterfall_svg(fall)} for fall in mine]


def _rankings(verdict: "Verdict") -> list[dict[str, Any]]:
    made = []
    for rung in dict.fromkeys(rank.rung for rank in verdict.ranks):
        mine = [rank for rank in verdict.ranks if rank.rung == rung]
        made.append(
            {"title": words.named(paper_names.RUNG_NAMES, rung), "share": bars.share_svg(mine), "clearance": bars.clearance_svg(mine)}
        )
    return made
