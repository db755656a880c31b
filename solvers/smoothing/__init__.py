"""Smoothing of given multi-block grids across their interfaces."""
