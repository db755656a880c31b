"""O grids by conformal lift: harmonic base and Winslow's equations in the periodic strip."""
