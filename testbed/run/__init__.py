"""MANY flights: one job, the engines that spread jobs over processes, the run directory."""
