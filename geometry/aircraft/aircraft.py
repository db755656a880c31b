"""A body with wings, from which the grid of an aircraft is made."""

from dataclasses import dataclass

from meshonet.geometry.aircraft.axes import FILE_AXES, AircraftAxes
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

_TAPER = 0.02  # smallest ratio of the shortest to the longest chord: all sections have equal numbers of cells


@dataclass(frozen=True, eq=False)
class Aircraft:
    """A body and wings that begin inside it; the grid is around the half z >= 0 or around both halves.

    Parameters
    ----------
    body : Body
        The fuselage: a body of revolution, or a `LoftedBody`.
    wing : Stack or SurfaceWing
        The wing, from inside the body to the tip, as sections or as a surface. Its longest chord is the unit
        of the first-cell height and of the far field.
    name : str, optional
        Name of the aircraft.
    half : bool, optional
        Whether the grid ends in the plane of symmetry. If not, its mirror image is added, with the same patch
        names.
    others : tuple of Stack or SurfaceWing, optional
        Further wings, such as a tail plane, canards or a `Fin`, each with its own name.
    axes : AircraftAxes, optional
        Axes of the files of the body and the wings, and of the grid.
    notes : tuple of str, optional
        Notes on changes of the body.

    Raises
    ------
    InputError
        A wing without a tip, with a very short chord, or with sections that are not airfoils; two patches
        with the same name.

    Examples
    --------
    >>> import meshonet
    >>> root = meshonet.Section(meshonet.read("naca:2415"), chord=2.0, z=0.0, x=3.5)
    >>> tip = meshonet.Section(meshonet.read("naca:2412"), chord=1.0, z=5.0, x=5.0)
    >>> body = meshonet.Body([[0, 0], [0.1, 0.3], [0.5, 0.55], [2, 0.6], [6, 0.6], [9, 0.2], [10, 0]])
    >>> jet = meshonet.Aircraft(body, meshonet.Stack((root, tip)))
    >>> grid = meshonet.stack(jet, around=49, span=9, first_cell=0.01, growth=1.4, far_field=6)
    >>> sorted({patch.name for patch in grid.patches})
    ['farfield', 'fuselage', 'symmetry', 'tip', 'wing']
    """

    body: Body
    wing: Stack | SurfaceWing
    name: str = "aircraft"
    half: bool = True
    others: tuple[Stack | SurfaceWing, ...] = ()
    axes: AircraftAxes = FILE_AXES
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        taken = ["symmetry", "farfield"]
        for number, (wing, names) in enumerate(zip(self.wings, self.patches, strict=True)):
            at = f"wings[{number}]"
            if isinstance(wing, Stack):
                _refuse_no_wing(wing, at)
            _refuse_name(names[0], [*taken, "tip"], f"{at}.name")
            taken += names
        _refuse_name(self.body.name, taken, "bodies[0].name")

    @property
    def wings(self) -> tuple[Stack | SurfaceWing, ...]:
        """All wings: `wing`, then `others`."""
        return (self.wing, *self.others)

    @property
    def patches(self) -> tuple[tuple[str, str], ...]:
        """For each wing, the name of its patch and the name of the patch of its tip."""
        first = self.wing.name or "wing"
        return ((first, "tip"), *((each.name, f"{each.name}-tip") for each in self.others))


def _refuse_no_wing(wing: Stack, at: str) -> None:
    """Raise InputError for a stack that is not a wing of airfoils with a tip."""
    if wing.kind != "wing":
        raise InputError(f"a {wing.kind} is no wing", "leave it out", place=f"{at}.kind")
    if wing.tip == "open":
        raise InputError("a wing of an aircraft has a tip", "make it round or flat", place=f"{at}.tip")
    for number, section in enumerate(wing.sections):
        if not isinstance(section.shape, Airfoil):
            problem, place = "a closed curve has no trailing edge", f"{at}.sections[{number}].outline"
            raise InputError(problem, "give an airfoil", place=place)
    for number, section in enumerate(wing.sections):
        if section.nodes is not None:
            problem, place = "levels of an aircraft do not follow panels", f"{at}.sections[{number}].nodes"
            raise InputError(problem, "leave nodes out", place=place)
    chords = [section.chord for section in wing.sections]
    if min(chords) < _TAPER * wing.chord:
        place = f"{at}.sections[{chords.index(min(chords))}].chord"
        remedy = f"use at least {_TAPER:g} of the longest, {wing.chord:g}"
        raise InputError(f"a chord of {min(chords):g}", remedy, place=place)


def _refuse_name(name: str, taken: list[str], place: str) -> None:
    """Raise InputError for an empty name, or that of another patch."""
    if not name or not name.isprintable():
        raise InputError(f"{name!r} is no name", "give letters and digits", place=place)
    if name in taken:
        raise InputError(f"{name} is the name of another patch", "give it another name", place=place)
