"""Boundary to grid: algebraic, elliptic, neural; and the guard that repairs folds."""

if __name__ == "solvers":
    raise ImportError("import meshonet.solvers in place of solvers: one file would be two modules")
