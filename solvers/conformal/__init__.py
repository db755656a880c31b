"""O grids by a conformal map: harmonic extension and Winslow's equations in the periodic strip."""
