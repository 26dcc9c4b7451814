"""The library's refusals, by name: one class for each reason why there is no answer. Each one's text says what to give instead.

All of them are ``ValueError``. Two families, because a caller treats them differently:

- ``Degenerate``: the numbers are in order, but what was asked for cannot be built from them. Whoever plans in flight meets these, and
  what follows is an outcome: no path, no direction.
- the others: the call itself is wrong, and stays wrong until somebody changes it.

===================  =================================================================================================
``NotNumbers``       not numbers, too few or too many of them, not finite, or of a size no formula here can carry
``WrongOption``      a name that does not exist, an option a method does not have, a value outside of its range
``WrongAnswer``      an avoidance method handed back something that is no ``Choice``
``SamePoint``        two points that must differ are the same, or as good as
``NoDirection``      a vector without length where its direction is needed
``OutOfProportion``  lengths so unlike, or so small, that the curve between them is rounding noise
``NoCurve``          no curve exists: nothing to sample
===================  =================================================================================================
"""


class Refusal(ValueError):  # noqa: N818  (what it is called says more than the suffix)
    """Any refusal of this library."""


class NotNumbers(Refusal):
    """Not finite numbers of a size that the formulas can carry."""


class WrongOption(Refusal):
    """A name, an option or a value that is not among those that exist."""


class WrongAnswer(Refusal):
    """A method's answer is none."""


class Degenerate(Refusal):
    """What was asked for cannot be built from these numbers."""


class SamePoint(Degenerate):
    """Two points that must differ coincide."""


class NoDirection(Degenerate):
    """A vector has no direction because it has no length."""


class OutOfProportion(Degenerate):
    """Lengths that differ by more than a curve between them can carry."""


class NoCurve(Degenerate):
    """There is no curve to sample."""
