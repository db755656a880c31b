"""Options for the surface or volume of a stack."""

from dataclasses import dataclass
from typing import ClassVar

from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolution
from meshonet.geometry.errors import InputError
from meshonet.solvers.stacking.section_nodes import GAP
from meshonet.solvers.stacking.wing_surface import DEFAULT_AROUND, DEFAULT_SPAN, WingSurface
from meshonet.solvers.volume_request import VolumeRequest

DEFAULT_FAR_FIELD = 15.0  # chords


@dataclass(frozen=True, kw_only=True)
class StackRequest(VolumeRequest):
    """Options of the surface or volume grid of stacked sections (wing, blade, duct), checked on construction.

    The unit of length is the longest chord; for a duct, it is the unit of the positions of sections.

    Parameters
    ----------
    around : int, optional
        Odd number of nodes around a section, with the repeated first node; by default 129.
    span : int, optional
        Number of nodes from the first section to the last; by default 49, or more in ducts and blades.
    cells : int, optional
        Approximate number of cells in the grid of a wing or blade; sets `around` and `span` if not given.
    base : float, optional
        Smallest height of trailing edges, in chords of each section; thinner edges are thickened. The default
        is 0.005, or 0.001 for a wing from a surface file.
    first_cell : float, optional
        First-cell height at every wall node; by default 1e-3.
    y_plus, reynolds, chord_fraction : float, optional
        First-cell height as y+ on a turbulent flat plate, at the fraction `chord_fraction` of its length. The
        Reynolds number is that of the longest chord, or of the widest section of a duct.
    layers : int, optional
        Number of nodes along each line from the wall, with the wall node; by default as `growth` requires.
    growth : float, optional
        Growth ratio of cells away from the wall, if `layers` is not given; by default 1.2.
    far_field : float, optional
        Distance of the far field; by default 15.
    revolve : float, optional
        Angle in degrees by which the z axis of a blade or duct is bent around `axis` from the first section
        to the last.
    axis : AxisLine, optional
        Axis of `revolve`, in the plane of the sections; by default the x axis.
    threads : int, optional
        Number of threads; by default all cores.
    percentiles : bool, optional
        Whether the quality includes percentiles.
    allow_invalid : bool, optional
        Whether a grid with folded cells is returned instead of an error.

    Raises
    ------
    InputError
        If a value is out of its range, or if parameters exclude each other or lack another that they need.
    """

    what: ClassVar[str] = "a stack"
    fewest_cells: ClassVar[int] = 1000
    around: int | None = None
    span: int | None = None
    base: float | None = None
    layers: int | None = None
    far_field: float = DEFAULT_FAR_FIELD
    revolve: float | None = None
    axis: AxisLine | None = None

    def __post_init__(self) -> None:
        self.check_first_cell()
        if not 1.0 < self.far_field <= 1e6:
            problem = f"{self.far_field:g} chords"
            raise InputError(problem, "use more than 1 and at most 1e6", parameter="far_field")
        if not self.height() >= 1e-12:
            raise InputError(f"{self.height():g}", "use 1e-12 or more", parameter="first_cell")
        if self.layers is not None and not 3 <= self.layers <= 100_000:
            raise InputError(f"{self.layers} nodes", "use 3 to 100000", parameter="layers")
        self.check_volume()
        if self.layers is not None and self.growth is not None:
            raise InputError("{layers} and {growth} both say how many there are", "give one of them")
        if self.turn is not None and self.turn.closed:
            raise InputError("a whole turn", "use less than 360", parameter="revolve")

    def check_far_field(self) -> None:
        """Raise InputError if the first cell is high relative to the distance of the far field."""
        if not self.height() < 0.5 * self.far_field:
            problem = f"{self.height():g} chords"
            raise InputError(problem, "use less than half of {far_field}", parameter="first_cell")

    @property
    def turn(self) -> Revolution | None:
        """The revolution by the angle `revolve` around `axis`; None if no angle is given."""
        return revolution(self.revolve, None, self.axis)

    @property
    def surface(self) -> WingSurface:
        """Node counts of the surface."""
        return WingSurface(
            self.around or DEFAULT_AROUND, self.span or DEFAULT_SPAN, GAP if self.base is None else self.base
        )
