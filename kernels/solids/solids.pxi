# Quality of cells of six faces.
