"""What flies: physics of growing fidelity behind one protocol, ``base.Plant``. A plant is a file here and a line in ``PLANTS``."""

PLANTS = {
    "kinematic": "testbed.flight.plants.kinematic:make_plant",
    "point_mass": "testbed.flight.plants.point_mass:make_plant",
    "jsbsim": "testbed.flight.plants.jsbsim:make_plant",
}
