"""Blocks of a quad mesh, and fewer of them."""
