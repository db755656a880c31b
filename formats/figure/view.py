"""The part of a grid that a picture shows, and the direction that it is seen from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.formats.figure.layers import Box
from meshonet.formats.figure.slices import Slice
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

SEEN_FROM = (-125.0, 25.0)
"""Azimuth and elevation in degrees that a surface is seen from unless said otherwise."""


@dataclass(frozen=True)
class View:
    """What of a grid is drawn.

    Parameters
    ----------
    zoom : x0, x1, y0, y1 of a flat picture; of one in space with z0, z1, where what is outside is left out.
    every : draw every so many-th line; None chooses.
    slice : a layer or a cut of a volume; None draws its walls, or all of its outer boundary without any.
    seen_from : azimuth and elevation in degrees; None is `SEEN_FROM`.
    """

    zoom: tuple[float, ...] | None = None
    every: int | None = None
    slice: Slice | None = None
    seen_from: tuple[float, float] | None = None

    @property
    def axes(self) -> Floats:
        """Unit vectors (3, 3) to the right, upwards and towards the viewer."""
        azimuth, elevation = np.radians(self.seen_from or SEEN_FROM)
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        towards = np.cos(elevation) * level + [0.0, 0.0, np.sin(elevation)]
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        return np.array([right, np.cross(towards, right), towards])


def check_flat(view: View) -> None:
    """Raise InputError for what only grids in space have: a slice, a direction that they are seen from."""
    for name, value in (("slice", view.slice), ("seen_from", view.seen_from)):
        if value is not None:
            raise InputError("the grid is in the plane", f"leave {{{name}}} out", parameter=name)


def flat_box(zoom: tuple[float, ...] | None, across: int | None = None) -> Box | None:
    """Return the box of a flat picture: of one in space, that of the directions other than `across`.

    Raises InputError: a box in space for a grid in the plane.
    """
    if zoom is None:
        return None
    if len(zoom) == 6 and across is not None:
        zoom = zoom[: 2 * across] + zoom[2 * across + 2 :]
    if len(zoom) != 4:
        raise InputError("this picture is flat", "use x0,x1,y0,y1 of its two directions", parameter="zoom")
    return zoom[0], zoom[1], zoom[2], zoom[3]
