"""What came out of flights, computed without flying."""
