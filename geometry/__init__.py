"""Boundaries and grids: curves, sampling, topologies, validation, quality."""

if __name__ == "geometry":
    raise ImportError("import meshonet.geometry in place of geometry: one file would be two modules")
