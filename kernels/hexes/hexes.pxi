# Meshes of cells of six faces over one table of nodes.
