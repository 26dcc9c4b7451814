"""ONE flight: the loop, its plants, autopilot, guidance, traffic and re-planning."""
