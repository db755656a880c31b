"""Gmsh's mesh and geometry files."""
