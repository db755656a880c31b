"""Conformal maps of the outside of a body."""
