"""Path following: from the state and the path to a command. A law is a file here and a line in ``GUIDANCE``."""

GUIDANCE = {
    "look_ahead": "testbed.flight.guidance.look_ahead:make_law",
    "l1": "testbed.flight.guidance.l1:make_law",
}
