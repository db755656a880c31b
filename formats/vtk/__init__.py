"""VTK's XML and legacy files."""
