"""From YAML to campaigns and flight plans, with the place of every word."""
