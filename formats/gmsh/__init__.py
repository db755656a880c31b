"""Gmsh's meshes, ``.msh`` 2.2 and 4.1, and its geometry, ``.geo``."""
