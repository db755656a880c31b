"""Surfaces of CAD files: faces bounded by curves, as the solvers of patches take them."""
