"""Elliptic (Winslow) grids by full multigrid."""
