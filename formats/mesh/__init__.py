"""Functions that the formats of unstructured meshes and structured grids share."""
