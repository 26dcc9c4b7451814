"""One folder for each question that a campaign can be judged by, and a line in ``STUDIES``; ``study.py`` is what they have in common.

What a study can do without a campaign is a command of `testbed`, and a line in ``COMMANDS``.
"""

STUDIES: dict[str, str] = {
    "none": "testbed.studies.study:Study",
    "scoam": "testbed.studies.scoam.study:Scoam",
    "lead_time": "testbed.studies.lead_time.study:LeadTimeStudy",
    "arena": "testbed.studies.arena.study:Arena",
}

ONCE_SAID = {"lead_time": None}
"""What was said of an ordinary flight before there were studies, and is part of its identity still: it is the same flight."""

COMMANDS: dict[str, str] = {
    "audit": "testbed.studies.scoam.audit.command:audit",
    "figures": "testbed.studies.scoam.figures.command:figures",
}
