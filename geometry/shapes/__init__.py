"""Shapes from geometry files: airfoils, outlines, bodies in domains; each can be sampled into a boundary."""
