"""The quality of grids as a page to read and to print."""
