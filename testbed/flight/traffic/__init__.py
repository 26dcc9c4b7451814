"""The obstacles as they truly are. A kind of track is a file here and a line in ``TRACKS``."""

TRACKS = {"straight": "testbed.flight.traffic.track:Track"}
