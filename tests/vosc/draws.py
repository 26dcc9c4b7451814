"""How many examples a property draws: a share of what the profile says (``tests/conftest.py``), so that a longer profile is longer here."""

from hypothesis import settings


def percent(share):
    """A decorator: this share of the profile's examples, for a property that is dear or needs few."""
    return settings(max_examples=max(1, settings.default.max_examples * share // 100))
