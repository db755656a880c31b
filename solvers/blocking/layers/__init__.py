"""Layers of cells at walls, and blocks around them."""
