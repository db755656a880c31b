"""Grids of many blocks that were given, smoothed across their interfaces."""
