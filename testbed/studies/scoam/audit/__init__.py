"""The numbers that the paper prints, put to the test."""
