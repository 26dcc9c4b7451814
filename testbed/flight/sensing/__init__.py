"""What of the truth a planner sees."""
