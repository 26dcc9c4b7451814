"""One folder for each question that a campaign can be judged by, and a line in ``STUDIES``."""

STUDIES: dict[str, str] = {}
