"""Rows of blades in an annular channel: profiles, hub and casing."""
