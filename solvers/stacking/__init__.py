"""Surfaces and volumes from sections that are placed in space."""
