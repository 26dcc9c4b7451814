"""What one does to an aircraft apart from flying a plan: trim, linearise, tune, write its data sheet."""
