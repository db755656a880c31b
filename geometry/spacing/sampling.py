"""The settings that turn a shape into edges of nodes."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from meshonet.geometry.arrays import TOPOLOGIES, Topology
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.laws import SPACINGS, Spacing

TrailingEdge: TypeAlias = Literal["auto", "exact", "round", "wedge"]
TRAILING_EDGES: tuple[TrailingEdge, ...] = get_args(TrailingEdge)
DEFAULT_NI = 200  # default node counts
DEFAULT_NJ = 100  # half as many as along xi
DEFAULT_FAR_FIELD = 15.0  # in chords
MULTIPLES = (8, 4, 2, 1)
"""Steps of nodes on which corners of airfoils are placed, so that grids can be coarsened.

It is the largest that divides the number of cells, and for which there are enough.
"""
MOST_NODES = 100_000  # per direction: more is taken for a typing error
OF_OUTLINES = ("ni", "nj", "nk", "topology", "spacing", "far_field", "corners", "viscous", "refined")
"""Fields of `Sampling` that closed curves use; all others are for airfoils only."""


@dataclass(frozen=True)
class Sampling:
    """Distribution of nodes on the boundary of a shape; values are checked on construction.

    Parameters
    ----------
    ni, nj : int, optional
        Numbers of nodes along xi (around the body) and along eta (away from it). None: as in the shape, or
        `DEFAULT_NI` and `DEFAULT_NJ` for a curve.
    nk : int, optional
        Number of nodes of a volume along zeta. None: as in the given volume. Planar grids have None.
    topology : {'auto', 'quad', 'o', 'c'}, optional
        Topology of the grid; ``auto``: the topology that suits the shape.
    spacing : str, optional
        Distribution of nodes along a wall, as for the option ``--spacing``. ``auto`` is ``curvature`` in C
        grids, and in any grid requested with a first-cell height. Else it is ``tanh`` around airfoils with
        `le_spacing` or `te_spacing`, ``conformal`` around other airfoils and smooth bodies, else ``uniform``.
    le_spacing, te_spacing : float, optional
        Length of the wall cells at the leading and at the trailing edge, in chords.
    far_field : float, optional
        Smallest distance of the outer boundary from the middle of the body, in chords of an airfoil or
        extents of another body. None: `DEFAULT_FAR_FIELD` if the grid has a far field. For marching from a
        surface: the distance in the unit of the surface.
    corners : tuple of 4 int, optional
        Indices, from 0, of the points that become the corners of a quad domain.
    te : {'auto', 'exact', 'round', 'wedge'}, optional
        Treatment of a blunt trailing edge: ``exact`` leaves it, ``round`` rounds its corners, ``wedge``
        closes it. ``auto`` is ``wedge`` for C grids of one block, which need a sharp edge, else ``exact``.
    wake : float, optional
        Length of the wake of a C grid in chords; None: the far-field distance.
    wake_nodes : int, optional
        Number of nodes from the trailing edge to the end of the wake. None: a number that suits its length.
    base_nodes : int, optional
        Number of nodes across a blunt trailing edge, corners included; odd for an O grid. None: by its width.
    base : float, optional
        Thickness in chords to which thinner trailing edges of airfoils are opened.
    smooth : float, optional
        Largest distance, in chords, of smoothing splines from the points of an airfoil, such as three times
        the standard deviation of noise. A trailing edge of at most this thickness is closed. Needs SciPy.
    refined : int, optional
        The node indices of corners are multiples of this number, so that the grid can be coarsened by it.
    viscous : bool, optional
        Whether cells at the wall will be thin. The topology ``auto`` is then ``c`` around airfoils with a
        sharp trailing edge.
    normalise : bool, optional
        Move the leading edge to (0, 0) and the trailing edge to (1, 0).

    Raises
    ------
    InputError
        A value out of its range.
    """

    ni: int | None = None
    nj: int | None = None
    topology: Topology | Literal["auto"] = "auto"
    spacing: Spacing = "auto"
    le_spacing: float | None = None
    te_spacing: float | None = None
    far_field: float | None = None
    corners: tuple[int, int, int, int] | None = None
    normalise: bool = False
    te: TrailingEdge = "auto"
    wake: float | None = None
    wake_nodes: int | None = None
    viscous: bool = False
    nk: int | None = None
    base_nodes: int | None = None
    base: float | None = None
    smooth: float | None = None
    refined: int = 1

    def __post_init__(self) -> None:
        for name, count in (("ni", self.ni), ("nj", self.nj), ("nk", self.nk)):
            if count is not None and not 2 <= count <= MOST_NODES:
                raise InputError(f"{name} = {count}", f"use 2 to {MOST_NODES}", parameter="res")
        for what, name, known in (
            ("topology", self.topology, ("auto", *TOPOLOGIES)),
            ("spacing", self.spacing, SPACINGS),
            ("trailing edge", self.te, TRAILING_EDGES),
        ):
            if name not in known:
                raise InputError(f"{what} {name!r} is not known", "use " + "/".join(known))
        for name, size, least, most in (
            ("le_spacing", self.le_spacing, "1e-9", "0.2"),
            ("te_spacing", self.te_spacing, "1e-9", "0.2"),
            ("base", self.base, "5e-4", "0.2"),
            ("smooth", self.smooth, "1e-7", "0.01"),
        ):
            if size is not None and not float(least) <= size <= float(most):
                raise InputError(f"{size:g} chords", f"use {least} to {most}", parameter=name)
        if self.far_field is not None and not 0.0 < self.far_field < math.inf:
            raise InputError(f"{self.far_field:g} is no distance", "give e.g. 20", parameter="far_field")
        if self.wake is not None and not 0.5 <= self.wake <= 1e6:
            raise InputError(f"{self.wake:g} chords", "use 0.5 to 1e6", parameter="wake")
        for name, count in (("wake_nodes", self.wake_nodes), ("base_nodes", self.base_nodes)):
            if count is not None and not 3 <= count <= MOST_NODES:
                raise InputError(f"{count} nodes", f"use 3 to {MOST_NODES}", parameter=name)
        if self.corners is not None and len(set(self.corners)) != 4:
            problem = f"corners {self.corners} are not four different points"
            raise InputError(problem, "give four point indices")

    def corner_steps(self, cells: int) -> tuple[int, ...]:
        """Return the steps to try, largest first, for the corners on a wall of `cells` cells.

        Node indices of corners become multiples of the step. If `refined` is above 1, it is the only step.

        >>> Sampling().corner_steps(404), Sampling().corner_steps(398), Sampling(refined=8).corner_steps(400)
        ((4, 2, 1), (2, 1), (8,))
        """
        if self.refined > 1:
            return (self.refined,)
        return MULTIPLES[MULTIPLES.index(math.gcd(cells, MULTIPLES[0])) :]

    def check_airfoil(self, what: str) -> None:
        """Raise InputError if a field is given that only airfoils use; `what` names the shape."""
        for name, value in vars(self).items():
            if name not in OF_OUTLINES and value != getattr(Sampling, name):
                remedy = f"leave {{{name}}} out, or write the points of an airfoil to a .dat file"
                raise InputError(f"{{{name}}} needs an airfoil", remedy, source=what)

    @property
    def radius(self) -> float:
        """Radius of the far field in chords. Raises InputError if it is not above 1."""
        radius = DEFAULT_FAR_FIELD if self.far_field is None else self.far_field
        if not 1.0 < radius <= 1e6:
            raise InputError(f"{radius:g} chords", "use more than 1 and at most 1e6", parameter="far_field")
        return radius


def first_within(steps: tuple[int, ...], most: float) -> int:
    """Return the first of the descending `steps` that is at most `most`, or else the last of them.

    >>> first_within((8, 4, 2, 1), 5.0), first_within((8,), 5.0)
    (4, 8)
    """
    for step in steps:
        if step <= most:
            return step
    return steps[-1]


def nodes_beside(cells: int, every: int) -> str:
    """Return as text how many nodes, near `cells` + 1, make the number of cells a multiple of `every`.

    >>> nodes_beside(49, 4), nodes_beside(3, 4)
    ('49 or 53', '5')
    """
    less = cells // every * every + 1
    return f"{less} or {less + every}" if less > 1 else f"{less + every}"
