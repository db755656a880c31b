"""Surfaces and volumes from sections placed in space."""
