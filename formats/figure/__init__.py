"""Pictures of grids, drawn by matplotlib."""
