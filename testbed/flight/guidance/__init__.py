"""Path following: from the state and the path to a command."""
