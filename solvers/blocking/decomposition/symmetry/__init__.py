"""Symmetric layouts of symmetric domains."""
