"""The obstacles as they truly are. A kind of track is a file here and a line in ``TRACKS``."""

from testbed.flight.traffic.track import Body, Sampled, Track, TrackSetting, Traffic

__all__ = ["TRACKS", "Body", "Sampled", "Track", "TrackSetting", "Traffic"]

TRACKS = {
    "straight": "testbed.flight.traffic.straight:make_track",
    "legs": "testbed.flight.traffic.legs:Legs",
    "waypoints": "testbed.flight.traffic.waypoints:Waypoints",
    "file": "testbed.flight.traffic.file:Recorded",
}
