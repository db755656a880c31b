"""Volumes swept along curves by sections of the plane."""
