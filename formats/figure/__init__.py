"""Pictures, interactive pages and quality reports of grids. Pictures are drawn by matplotlib."""
