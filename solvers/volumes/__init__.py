"""Volume grids inside six faces."""
