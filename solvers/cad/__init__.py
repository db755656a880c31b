"""Patches of structured nodes on the faces of CAD files."""
