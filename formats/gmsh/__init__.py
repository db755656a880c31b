"""Gmsh's meshes, ``.msh`` 2.2 and 4.1, and its geometry, ``.geo``."""

from meshonet.formats.format import Format, Options, later


def sniff(head: bytes) -> bool:
    """Say whether `head` is of a Gmsh mesh."""
    return b"$MeshFormat" in head[:4096]


def _mesh(options: Options = frozenset()) -> Format:
    return Format(
        name="gmsh",
        suffixes=(".msh",),
        description="Gmsh mesh, patches as physical groups; read as a boundary",
        read_shapes=later(f"{__name__}.read:read_shapes"),
        write_grids=later(f"{__name__}.msh:write_grids", options=options),
        write_extruded=later(f"{__name__}.msh:write_extruded", options=options),
        sniff=sniff,
        names_patches=True,
        choices=(("binary", "ascii"), ("2.2", "4.1")),
        variant=_mesh,
    )


FORMATS = (
    _mesh(),
    Format(
        name="geo",
        suffixes=(".geo",),
        description="Gmsh geometry: the outer edges as transfinite curves, patches as physical groups",
        write_grids=later(f"{__name__}.geo:write_grids"),
        names_patches=True,
    ),
)
