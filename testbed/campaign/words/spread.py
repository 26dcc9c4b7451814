"""How a quantity of an encounter is distributed, and how often its rare values are drawn."""

from typing import Annotated, Any

from pydantic import BeforeValidator, model_validator

from testbed.core.section import NonNegative, Number, Positive, Section


class Spread(Section):
    """How a quantity is distributed: evenly between two numbers, or in bins that are as likely as ``chances`` says, evenly in each.

    ``drawn``: how often each bin is drawn instead, where rare ones are wanted more often than they are; each encounter then has the
    weight that makes up for it, its chance over how often it is drawn.
    """

    between: tuple[Number, Number] | None = None
    """Least and largest value."""
    edges: tuple[Number, ...] = ()
    """Edges of the bins, one more than there are bins."""
    chances: tuple[NonNegative, ...] = ()
    """How likely each bin is, as a share of their sum: [0.5, 0.6] is 5 to 6. They need not add up to 1."""
    drawn: tuple[Positive, ...] = ()
    """How often each bin is drawn, as a share of their sum; without it as likely as it is."""

    @model_validator(mode="after")
    def _is_one(self) -> "Spread":
        if (self.between is None) == (not self.edges):
            raise ValueError("give a number, [least, largest], or edges with chances")
        if self.between is not None and (self.chances or self.drawn):
            raise ValueError("chances and drawn go with edges")
        if list(self.edges) != sorted(set(self.edges)) or (self.between and self.between[0] > self.between[1]):
            raise ValueError("must not go down" if self.between else "edges: must go up")
        if self.edges and (len(self.edges) < 2 or len(self.chances) != len(self.edges) - 1):
            raise ValueError(f"chances: has {len(self.chances)} for {max(0, len(self.edges) - 1)} bins")
        if self.edges and not sum(self.chances) > 0.0:
            raise ValueError("chances: one must be more than 0")
        if self.drawn and len(self.drawn) != len(self.chances):
            raise ValueError(f"drawn: has {len(self.drawn)} for {len(self.chances)} bins")
        return self

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest value."""
        return self.between or (self.edges[0], self.edges[-1])

    def at(self, share: float) -> tuple[float, float]:
        """(value, weight) for a number that is even from 0 to 1."""
        if self.between is not None:
            return self.between[0] + share * (self.between[1] - self.between[0]), 1.0
        drawn, chance = self.drawn or self.chances, sum(self.chances)
        left, total = share * sum(drawn), sum(drawn)
        k, last = 0, max(k for k, often in enumerate(drawn) if often > 0.0)
        while k < last and left >= drawn[k]:
            left -= drawn[k]
            k += 1
        within = min(max(left / drawn[k], 0.0), 1.0)
        return self.edges[k] + within * (self.edges[k + 1] - self.edges[k]), (self.chances[k] / chance) / (drawn[k] / total)


def _spelt_out(value: Any) -> Any:
    """``40`` and ``[20, 50]`` are short for a spread between."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {"between": (value, value)}
    return {"between": value} if isinstance(value, list | tuple) else value


Spreading = Annotated[Spread, BeforeValidator(_spelt_out)]


def within(name: str, spread: Spread, least: float, most: float, unit: str) -> None:
    """Raise ``ValueError`` unless all values are between two."""
    low, high = spread.ends
    if not least <= low <= high <= most:
        raise ValueError(f"{name}: must be between {least:g} and {most:g} {unit}, not {low:g} to {high:g}")
