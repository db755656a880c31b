"""SU2's own mesh format."""
