"""The part of a grid that a picture shows, and the direction of view."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.formats.figure.layers import Box
from meshonet.formats.figure.slices import Slice, parse_slice
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

SEEN_FROM = (-125.0, 25.0)  # default azimuth and elevation in degrees


@dataclass(frozen=True)
class View:
    """The part of a grid that is drawn, and the direction of view.

    Parameters
    ----------
    zoom : box x0, x1, y0, y1, for grids in 3-D also z0, z1; cells outside are not drawn.
    every : step between drawn lines; None: selected by the resolution of the picture.
    slice : slice of a volume, ``i=10``, ``k=-1`` or ``x=.5``; None: the walls, or without walls the boundary.
    seen_from : azimuth and elevation of the viewer in degrees, for grids in 3-D; None is `SEEN_FROM`.
    up : axis that points upwards in the picture, for grids in 3-D; elevation 0 is normal to this axis.
    span : fractions (0 at the hub, 1 at the shroud) at which sections of a blade row are drawn.
    meridional : whether the meridional section of a blade row is drawn.

    Raises InputError if a parameter is invalid.
    """

    zoom: tuple[float, ...] | None = None
    every: int | None = None
    slice: Slice | str | None = None
    seen_from: tuple[float, float] | None = None
    up: str | None = None
    span: tuple[float, ...] = ()
    meridional: bool = False

    def __post_init__(self) -> None:
        zoom = self.zoom or (0, 1, 0, 1)
        pairs = list(zip(zoom[::2], zoom[1::2], strict=False))
        if len(zoom) not in (4, 6) or not all(math.isfinite(a + b) and a < b for a, b in pairs):
            box = ",".join(f"{x:g}" for x in zoom)
            remedy = "use x0,x1,y0,y1 with x0 < x1 and y0 < y1, e.g. 0.9,1.1,-0.1,0.1"
            raise InputError(f"{box!r} is not a box", remedy, parameter="zoom")
        if self.seen_from is not None and not all(map(math.isfinite, self.seen_from)):
            remedy = "use azimuth and elevation in degrees, e.g. -125,25"
            raise InputError(f"{self.seen_from} is no direction", remedy, parameter="seen_from")
        if self.up not in (None, *"xyz"):
            raise InputError(f"{self.up!r} is no axis", "use x, y or z", parameter="up")
        if self.every is not None and self.every < 1:
            problem = f"every {self.every}-th line cannot be drawn"
            raise InputError(problem, "use 1 or more", parameter="every")
        for span in self.span:
            if not 0.0 < span < 1.0:
                raise InputError(f"{span:g} of the span", "use more than 0 and less than 1", parameter="span")
        chosen = [name for name in ("slice", "span", "meridional") if getattr(self, name)]
        if len(chosen) > 1:
            problem = f"{{{chosen[0]}}} and {{{chosen[1]}}} are different pictures"
            raise InputError(problem, "give one of them")
        _ = self.part

    @property
    def of_row(self) -> bool:
        """Whether sections of a blade row are drawn."""
        return self.meridional or bool(self.span)

    @property
    def part(self) -> Slice | None:
        """The slice as a `Slice`; None without a slice."""
        return parse_slice(self.slice) if isinstance(self.slice, str) else self.slice

    @property
    def axes(self) -> Floats:
        """Unit vectors (3, 3) that point to the right, upwards and towards the viewer.

        The azimuth is measured from the axis that follows `up` in the cyclic order x, y, z.
        """
        azimuth, elevation = np.radians(self.seen_from or SEEN_FROM)
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        towards = np.cos(elevation) * level + [0.0, 0.0, np.sin(elevation)]
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        return np.roll([right, np.cross(towards, right), towards], self.axis_up + 1, axis=1)

    @property
    def axis_up(self) -> int:
        """Number of the axis that points upwards."""
        return "xyz".index(self.up or "z")


def check_flat(view: View) -> None:
    """Raise InputError if `view` has a setting that applies only to three-dimensional grids."""
    settings = {"span": view.span or None, "meridional": view.meridional or None, "slice": view.slice}
    for name, value in (settings | {"seen_from": view.seen_from, "up": view.up}).items():
        if value is not None:
            raise InputError("the grid is in the plane", f"leave {{{name}}} out", parameter=name)


def flat_box(zoom: tuple[float, ...] | None, across: int | None = None) -> Box | None:
    """Return `zoom` without the two limits of axis `across` (0, 1 or 2) if it has six limits.

    Raises InputError unless four limits are left.
    """
    if zoom is None:
        return None
    if len(zoom) == 6 and across is not None:
        zoom = zoom[: 2 * across] + zoom[2 * across + 2 :]
    if len(zoom) != 4:
        raise InputError("this picture is flat", "use x0,x1,y0,y1 of its two directions", parameter="zoom")
    return zoom[0], zoom[1], zoom[2], zoom[3]


def nothing_in(zoom: Sequence[float], low: Floats, high: Floats) -> InputError:
    """Return the error for a window `zoom` that contains no cell of a grid, which lies in `low` to `high`."""
    spans = ", ".join(f"{name} {a:.4g} to {b:.4g}" for name, a, b in zip("xyz", low, high, strict=False))
    return InputError(f"zoom {zoom} shows none of the grid", f"it spans {spans}", parameter="zoom")
