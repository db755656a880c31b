"""Text files of coordinates: airfoils and lists of points; conversion of numbers to and from text."""
