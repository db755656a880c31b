"""Boundary to grid: algebraic, elliptic, neural; and the guard that repairs folds."""
