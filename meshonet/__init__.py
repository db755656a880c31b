"""Structured, body-fitted grids from a boundary."""
