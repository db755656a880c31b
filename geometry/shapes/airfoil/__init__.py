"""Airfoils: from coordinates as found to a clean section whose trailing edge is known."""
