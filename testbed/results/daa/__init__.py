"""Detect and avoid: how near two aircraft came by the measures of the standards, and what avoidance did to the risk."""
