"""Pages that are made of the help texts."""
