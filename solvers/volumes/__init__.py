"""Volumes inside six faces."""
