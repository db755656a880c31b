"""Grids of blade rows: sections in (m', theta), stacked along the span."""
