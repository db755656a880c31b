"""VTK files: XML structured grids, multi-block and legacy structured grids."""
