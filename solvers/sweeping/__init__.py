"""Volume grids by sweeping planar sections along curves."""
