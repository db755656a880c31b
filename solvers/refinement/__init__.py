"""Layouts of blocks with other numbers of cells: chords, target sizes, splines through blocks."""
