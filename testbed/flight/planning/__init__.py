"""From what is seen to a new path, and back."""
