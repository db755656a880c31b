"""Loops from closed polygons as files contain them: of either orientation, some points repeated."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, ends_meet, extent_of
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import check_extent, polygon_area
from meshonet.geometry.polygon.self_intersection import check_outline


def ring_loop(
    points: Floats,
    *,
    hole: bool,
    corners: Sequence[int] | None = None,
    names: Sequence[str] = ("outer",),
    places: Sequence[str] = (),
) -> Loop:
    """Return the loop that follows a polygon exactly, with the domain on its left.

    Parameters
    ----------
    points : (n, 2) points of the polygon in either direction; repeated neighbours are removed.
    hole : whether the domain is outside the polygon.
    corners : indices of the points that are corners; None detects them by their turning angles.
    names : one name, or one for each part between corners, in the order of `corners`.
    places : position of each point in the input, for messages.

    Raises InputError: there are fewer than three points or no area; the polygon crosses or touches itself; a
    corner index is out of range; the number of names is wrong.
    """
    points, number, places = _distinct(points, places)
    check_extent(extent_of(points))
    check_outline(points, places)
    area, extent = polygon_area(points), extent_of(points)
    if abs(area) < 1e-12 * extent**2:
        raise InputError("a ring has no area", "give the points around a domain or a hole")
    if corners is None:
        loop = Loop.of_polygon(points)
        chosen = list(loop.corners)
    else:
        chosen = _numbered(corners, number)
    labels = _labels(names, len(chosen), detected=corners is None)
    order = np.argsort(chosen, kind="stable")
    chosen, labels = [chosen[k] for k in order], [labels[k] for k in order] if len(labels) > 1 else labels
    if (area > 0) == hole:  # reversed, with the same first point
        n, ends = len(points), chosen[1:] + chosen[:1]
        points = np.roll(points[::-1], 1, axis=0)
        places = (*places[:1], *places[:0:-1])
        turned = sorted(zip(((n - end) % n for end in ends), labels, strict=True)) if len(labels) > 1 else []
        chosen = sorted((n - corner) % n for corner in chosen)
        labels = [label for _, label in turned] or labels
    return replace(Loop.of_polygon(points, tuple(chosen), tuple(labels)), places=tuple(places))


def _distinct(points: Floats, places: Sequence[str]) -> tuple[Floats, Indices, tuple[str, ...]]:
    """Return the points without repeated neighbours, the new index of each given point, and the places."""
    keep = np.append(True, (np.diff(points, axis=0) != 0).any(axis=1))[: len(points)]
    number = np.cumsum(keep) - 1
    kept = points[keep]
    if ends_meet(kept):
        number[number == len(kept) - 1] = 0
        kept, keep[np.flatnonzero(keep)[-1]] = kept[:-1], False
    if len(kept) < 3:
        raise InputError(f"a ring of {len(kept)} different points", "give at least 3")
    return kept, number, tuple(place for place, stays in zip(places, keep, strict=False) if stays)


def _numbered(corners: Sequence[int], number: Indices) -> list[int]:
    for corner in corners:
        if not 0 <= corner < len(number):
            raise InputError(
                f"corner {corner} of a ring of {len(number)} points", f"use 0 to {len(number) - 1}"
            )
    chosen = [int(number[corner]) for corner in corners]
    if len(set(chosen)) < len(chosen):
        raise InputError(f"corners {list(corners)} name a point twice", "name each once")
    return chosen


def _labels(names: Sequence[str], corners: int, *, detected: bool) -> list[str]:
    if len(names) == 1 or len(names) == corners:
        return list(names)
    stretches = f"{corners} corner{'' if corners == 1 else 's'}{' that were found' if detected else ''}"
    remedy = "give one name, or one for each stretch from a corner to the next"
    raise InputError(f"{len(names)} names and {stretches}", remedy)
