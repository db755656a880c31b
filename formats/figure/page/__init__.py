"""Interactive pages of grids: data, program and style in a single HTML file that needs no network."""
