"""Sections of wings, blades and ducts, placed in space."""
