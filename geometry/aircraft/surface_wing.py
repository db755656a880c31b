"""A wing given as a surface: strips of nodes from its root on a body to its tip."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from meshonet.geometry.aircraft.wing_strips import at_heights, on_line
from meshonet.geometry.arrays import Floats, arc_lengths, cross2, norms
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.notes import Change
from meshonet.geometry.sections.stack import Tip

_NOSE = 0.02  # a joint of two strips is the nose if it is this close, in chords, to the foremost point
_SLIM = 0.95  # a tip closes if its thickness-to-chord ratio is below this fraction of that one chord inboard
_SHORT = 0.05  # smallest allowed ratio of the chord of the tip to the longest chord
_CLOSING = 0.1  # fraction of the span, at the tip, in which z need not increase along the lines
_LEVELS = 33  # number of heights between root and tip at which chords are measured


@dataclass(frozen=True, eq=False)
class SurfaceWing:
    """A wing given by its nodes at stations along the span, with straight lines between stations.

    Around the section, the surface is divided into strips, each from root to tip. They are numbered from the
    trailing edge over the upper side to the nose and back. A strip is an array (stations, n, 3): n nodes at
    each station, with a cubic spline through them. z increases along the span; the wing ends at a constant z.
    Raises InputError: a strip of another shape; a line along the span on which z does not increase.
    """

    strips: tuple[Floats, ...]  # (stations, n, 3) nodes of each strip
    height: float  # z of the plane in which the wing ends
    name: str = "wing"  # name of the wing and of its patch
    notes: tuple[str, ...] = ()  # sentences on changes
    tip: Tip = "flat"

    def __post_init__(self) -> None:
        for number, strip in enumerate(self.strips):
            if strip.ndim != 3 or strip.shape[2] != 3 or min(strip.shape[:2]) < 2:
                problem = f"a strip of shape {strip.shape}"
                raise InputError(problem, "give (stations, nodes, 3)", place=f"strips[{number}]")
            steps = np.diff(strip[..., 2], axis=0)
            if not steps.min() > 0.0:
                row, column = np.unravel_index(int(steps.argmin()), steps.shape)
                where = place_of(strip[row, column])
                problem = f"a line along the span of the {self.name} turns back at {where}"
                raise InputError(problem, "give lines along which the distance from the body rises")

    @classmethod
    def ending(cls, strips: tuple[Floats, ...], name: str = "wing") -> Self:
        """Return the wing with these `strips` (see the class), cut off where it becomes thin near its tip.

        Raises InputError if the wing has no thickness.
        """
        strips = tuple(map(_rising, strips))
        end = min(float(strip[-1, :, 2].min()) for strip in strips)
        wing = cls(strips, end, name)
        heights = max((strip[:, :, 2].min(axis=1) for strip in strips), key=len)
        heights = np.append(heights[(heights > wing.z[0]) & (heights < end)], end)
        chord, thick = wing.sizes(heights)
        if chord.max() <= 0.0 or thick.max() <= 0.0:
            raise InputError(f"the {name} has no thickness", "give its upper and its lower side")
        share = thick / np.where(chord > 0.0, chord, 1.0)
        before = float(np.interp(end - chord[-1], heights, share))
        fit = np.flatnonzero((share >= _SLIM * before) & (chord >= _SHORT * chord.max()))
        last = float(heights[fit[-1]]) if len(fit) else end
        if last == end:
            return wing
        closing = f"the tip of the {name} is flat, where its thickness begins to shrink"
        note = f"{closing}: the last {end - last:.3g} of its span are left out"
        return replace(wing, height=last, notes=(Change(note),))

    @property
    def z(self) -> Floats:
        """Equally spaced z (n,) along the span, from the largest z of the root curve to the z of the tip."""
        begin = max(float(strip[0, :, 2].max()) for strip in self.strips)
        return np.linspace(begin, self.height, _LEVELS)

    @property
    def chords(self) -> Floats:
        """Chords (n,) of the sections at `z`."""
        return self.sizes(self.z)[0]

    @property
    def chord(self) -> float:
        """Longest chord of the wing."""
        return float(self.chords.max())

    @property
    def end(self) -> tuple[float, float, float]:
        """Nose of the last section, as x, y, z."""
        x, y, z = on_line(self.line(self.nose), np.array([self.height]))[0].tolist()
        return x, y, z

    @cached_property
    def arcs(self) -> Floats:
        """Arc lengths (n,), in chords, across the n strips of the surface, which run from root to tip.

        They are measured around the section half way along the span.
        """
        z = self.z[[_LEVELS // 2]]
        lengths = [float(norms(np.diff(at_heights(strip, z)[0], axis=0)).sum()) for strip in self.strips]
        return np.array(lengths) / self.sizes(z)[0]

    @cached_property
    def nose(self) -> float:
        """Place of the nose around the section.

        The surface has strips from root to tip. Place 1.25 is a quarter of the way across the second strip.
        """
        z = self.z[[_LEVELS // 2]]
        rows = [at_heights(strip, z)[0] for strip in self.strips]
        edge = 0.5 * (rows[0][0] + rows[-1][-1])
        apart = [norms(row - edge) for row in rows]
        most = max(float(each.max()) for each in apart)
        for number in range(1, len(rows)):
            if apart[number][0] >= (1.0 - _NOSE) * most:
                return float(number)
        number = max(range(len(rows)), key=lambda k: float(apart[k].max()))
        way = arc_lengths(rows[number])
        return number + float(way[int(apart[number].argmax())] / way[-1])

    def line(self, place: float) -> Floats:
        """Return the line (stations, 3) along the span at a `place` around the section.

        The surface has strips from root to tip. Place 1.25 is a quarter of the way across the second strip.
        """
        return self.lines(np.array([place]))[0]

    def lines(self, places: Floats) -> list[Floats]:
        """Return lines (stations, 3) along the span at ascending `places` around the section (see `line`)."""
        numbers = np.minimum(places.astype(int), len(self.strips) - 1)
        out: list[Floats] = []
        for number in range(len(self.strips)):
            parts = places[numbers == number] - number
            out += list(np.moveaxis(self._splines(number, parts), 1, 0))
        return out

    def arc(self, place: float) -> float:
        """Return the arc length, in chords, from the upper trailing edge to `place` (see `line`)."""
        return float(np.interp(place, np.arange(len(self.strips) + 1), self._bounds))

    def places(self, arcs: Floats) -> Floats:
        """Return the places (n,) around the section at arc lengths `arcs` (n,) from the upper trailing edge.

        Arc lengths are in chords. Place 1.25 is a quarter of the way across the second strip of the surface.
        """
        return np.interp(arcs, self._bounds, np.arange(len(self.strips) + 1))

    @property
    def _bounds(self) -> Floats:
        return np.append(0.0, np.cumsum(self.arcs))

    def base(self, z: Floats) -> Floats:
        """Return the thickness (n,) of the blunt trailing edge in chords, at positions `z` (n,)."""
        upper, lower = self.edges(z)
        across = upper - lower
        along = 0.5 * (upper + lower) - on_line(self.line(self.nose), z)
        square = cross2(along, across)
        return np.asarray(np.abs(square) / (along[:, :2] ** 2).sum(axis=1))

    def edges(self, z: Floats) -> tuple[Floats, Floats]:
        """Return the upper and the lower corners (n, 3) of the trailing edge at positions `z` (n,)."""
        return on_line(self.line(0.0), z), on_line(self.line(float(len(self.strips))), z)

    def opened(self, least: float) -> Self:
        """Return the wing with a trailing edge at least `least` chords thick; a change is noted.

        The added thickness is proportional to the distance from the nose.
        """
        thin = float(self.base(self.z).min())
        if thin >= least * (1.0 - 1e-9):
            return self
        strips = tuple(self._thicker(number, least) for number in range(len(self.strips)))
        note = f"the trailing edge of the {self.name}, {thin:.2g} chords high, is opened to {least:g} chords"
        return replace(self, strips=strips, notes=(*self.notes, Change(note)))

    def _thicker(self, number: int, least: float) -> Floats:
        strip = self.strips[number]
        z = strip[..., 2].ravel()
        nose, (upper, lower) = on_line(self.line(self.nose), z), self.edges(z)
        chord = (0.5 * (upper + lower) - nose)[:, :2]
        square = (chord * chord).sum(axis=1)
        normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.sqrt(square)[:, None]
        height = ((upper - lower)[:, :2] * normal).sum(axis=1)
        missing = 0.5 * np.maximum(least * np.sqrt(square) - height, 0.0)
        along = np.clip(((strip.reshape(-1, 3) - nose)[:, :2] * chord).sum(axis=1) / square, 0.0, None)
        columns = np.arange(strip.shape[1]) / (strip.shape[1] - 1)
        sign = np.where(number + columns < self.nose, 1.0, -1.0) + np.zeros(strip.shape[:2])
        moved = strip.copy()
        moved[..., :2] += ((sign.ravel() * missing * along)[:, None] * normal).reshape(*strip.shape[:2], 2)
        return moved

    def _splines(self, number: int, parts: Floats) -> Floats:
        """Return lines (stations, n, 3) at fractions (n,) of the way across a strip."""
        rows = []
        for row in self.strips[number]:
            arcs = arc_lengths(row)
            rows.append(CubicTable(row, arcs)(parts * arcs[-1]))
        return np.stack(rows)

    def sizes(self, z: Floats) -> tuple[Floats, Floats]:
        """Return the chord (n,) and the largest thickness (n,) of the sections at positions `z` (n,)."""
        loops = np.concatenate([at_heights(strip, z) for strip in self.strips], axis=1)
        chord = loops[:, 0] + loops[:, -1]
        apart = norms(loops - 0.5 * chord[:, None])
        at = apart.argmax(axis=1)
        nose = loops[np.arange(len(z)), at]
        along = 0.5 * chord - nose
        length = norms(along)
        high = cross2(along[:, None], loops - nose[:, None]) / np.where(length > 0.0, length, 1.0)[:, None]
        return length, np.asarray(np.ptp(high, axis=1))


def _rising(strip: Floats) -> Floats:
    """Return a strip without last stations to which z does not rise, as at a closed tip."""
    flat = np.flatnonzero((np.diff(strip[..., 2], axis=0) <= 0.0).any(axis=1))
    if not flat.size:
        return strip
    left_out = strip[-1, :, 2].max() - strip[flat[0], :, 2].min()
    return strip[: flat[0] + 1] if left_out <= _CLOSING * np.ptp(strip[..., 2]) else strip
