"""What cannot be, by name: a plan that no flight can follow, a way that leads nowhere. Each is an outcome or an event, told by its text.

Whoever plans or flies catches these and no other: a ``ValueError`` is a fault of the program, and must not pass for an answer.
"""


class ImpossibleError(Exception):
    """What was asked for cannot be; the text is for users."""


class NoRouteError(ImpossibleError):
    """There is no such route, no such place on it, or it cannot be flown along."""


class NoMeetingError(ImpossibleError):
    """An obstacle cannot be put where, or when, the plan wants it."""


class NoWayError(ImpossibleError):
    """No path leads from here to there."""
