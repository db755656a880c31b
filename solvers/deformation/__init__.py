"""Given grids that follow a changed boundary."""
