"""Numbers of cells of the blocks of a layout, and cell sizes."""
