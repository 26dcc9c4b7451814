"""Paths in space and time: planners that search for a whole path to the goal past everything in sight, within the aircraft's limits.

One file each, and a line in ``PATHS``: a campaign names them beside the planners (``planner: {kind: lattice}``). All of them look for the
same thing (``course.py``): PH curves through a few waypoints, without a jump in bank, from the present state to the goal. All are held
to the same test (``validity.py``): flown at the present speed, the path keeps every sphere's radius where that sphere is when the
aircraft comes by, and what it asks of load factor, bank, roll rate and climb is within the aircraft's limits. What they differ in is how
they look; each has a budget that is counted, not timed. The answer is a path that passes, or none, and which limit forbids it.
"""

PATHS = {
    "lattice": "testbed.flight.paths.lattice:Lattice",
    "rrt": "testbed.flight.paths.rrt:RandomTree",
    "genetic": "testbed.flight.paths.genetic:Genetic",
    "particle_swarm": "testbed.flight.paths.swarm:ParticleSwarm",
}
