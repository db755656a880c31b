"""What a boundary and a grid are: curves, sampling, topologies, validation, quality."""
