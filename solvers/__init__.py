"""Grid generation: from boundaries to grids, and repair of folded cells."""

if __name__ == "solvers":
    raise ImportError("import meshonet.solvers in place of solvers: one file would be two modules")
