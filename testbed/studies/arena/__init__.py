"""The arena: every method in its own shape, at its own best lead, on the same encounters. What is compared is in ``docs/arena.md``."""
