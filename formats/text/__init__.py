"""Text files of coordinates: airfoils and lists of points; and numbers as text."""

from meshonet.formats.format import Format, later

FORMATS = (
    Format(
        name="airfoil",
        suffixes=(".dat",),
        description="airfoil coordinates, Selig or Lednicer",
        read_shapes=later(f"{__name__}.airfoil_dat:read_shapes"),
        sniff=later(f"{__name__}.airfoil_dat:sniff"),
    ),
    Format(
        name="points",
        suffixes=(".csv", ".txt", ".xy"),
        description="points of a closed curve or of four edges",
        read_shapes=later(f"{__name__}.points:read_shapes"),
        sniff=later(f"{__name__}.points:sniff"),
    ),
)
