"""What unstructured meshes and structured grids have in common: names, loops, patches, recovered topology."""
