"""Coarse grids evaluated at any resolution, boundaries met exactly."""
