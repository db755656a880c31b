"""Pages that are generated from the help texts."""
