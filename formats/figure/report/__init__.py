"""Quality reports of grids as HTML pages."""
