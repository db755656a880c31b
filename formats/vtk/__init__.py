"""VTK's files: XML structured grids, single and as blocks, legacy structured grids, unstructured grids."""
