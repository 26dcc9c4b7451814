"""What flies: plants of growing fidelity behind one protocol (see ``base``)."""
