"""Plot3D grids, read in every layout, and NASA's neutral map file beside them.

https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

CHOICES = (
    ("ascii", "binary", "fortran"),
    ("multi", "single"),
    ("2d", "3d"),
    ("no-iblank", "iblank"),
    ("little", "big"),
    ("float64", "float32"),
    ("whole", "planes"),
    ("span-k", "span-i", "span-j"),
)
"""What a Plot3D file does not say of itself, of each row one word; the first is what is written by default.

``single`` has no count of blocks in front; ``iblank`` an integer a node behind the coordinates; ``planes`` x,
y and z of one k after the other in place of all x, all y, all z; ``span-i`` the planes of a grid that is
repeated in z along the first index, as FUN3D and NASA have it, ``span-j`` along the second.
"""
