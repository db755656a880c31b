"""Plot3D grids, read in every layout, and NASA's neutral map file beside them.

https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

from meshonet.formats.format import Format, Options, later

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


def _grid(options: Options = frozenset()) -> Format:
    return Format(
        name="plot3d",
        suffixes=(".p3d", ".xyz", ".fmt", ".x", ".dat", ".bin", ".ufmt", ".unf"),
        description="Plot3D: text, C binary (.bin) or Fortran records (.ufmt)",
        read_grids=later(f"{__name__}.read:read_grids", options=options),
        write_grids=later(f"{__name__}.write:write_grids", options=options),
        write_extruded=later(f"{__name__}.write:write_extruded", options=options),
        sniff=later(f"{__name__}.read:sniff"),
        many=True,
        choices=CHOICES,
        variant=_grid,
        suffix_options={".bin": "binary", ".ufmt": "fortran", ".unf": "fortran"},
    )


FORMATS = (
    _grid(),
    Format(
        name="nmf",
        suffixes=(".nmf",),
        description="NASA neutral map file: the boundary conditions and the cut of a Plot3D block",
        write_grids=later(f"{__name__}.nmf:write_grids"),
        write_extruded=later(f"{__name__}.nmf:write_extruded"),
        names_patches=True,
    ),
)
