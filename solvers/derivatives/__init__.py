"""Derivatives of a grid's nodes by nodes of its boundary."""
