"""Quality of grids: metrics, growth, walls, and the thresholds of other programs."""
