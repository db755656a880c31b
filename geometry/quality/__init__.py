"""How good a grid is: metrics, growth, walls, and the thresholds that others use."""
