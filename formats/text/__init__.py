"""Text files of coordinates: airfoils and lists of points; and numbers as text."""
