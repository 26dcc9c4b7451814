"""The path that is flown: its shape, and a table of it for the loop."""
