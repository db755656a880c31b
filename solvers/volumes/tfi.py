"""Transfinite interpolation of a volume from its six faces."""

from typing import get_args

from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.tfi import Blending
from meshonet.solvers.solution import Solution, timed
from meshonet.solvers.volumes.edge_corners import check_hand
from meshonet.solvers.volumes.interpolate import arc_laws, interpolate, uniform_laws


@timed
def tfi(faces: SixFaces, *, blending: Blending = "arclength") -> Solution:
    """Return the grid of a volume by transfinite interpolation between its six faces.

    The parameters of nodes are interpolated from the edges: relative arc lengths (``arclength``) or relative
    indices (``linear``). Cells may fold where faces are bent. Raises InputError if an edge has no length, the
    blending is unknown, or the volume is left-handed.
    """
    if blending not in get_args(Blending):
        remedy = "use " + "/".join(get_args(Blending))
        raise InputError(f"blending {blending!r} is not known", remedy, parameter="blending")
    check_hand(faces)
    laws = arc_laws(faces) if blending == "arclength" else uniform_laws(faces.counts)
    grid = faces.grid(interpolate(faces, laws), {"method": "tfi", "blending": blending})
    return Solution(grid, "tfi")
