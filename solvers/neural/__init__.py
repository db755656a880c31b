"""The neural operator: boundary to grid in one pass, in numpy."""
