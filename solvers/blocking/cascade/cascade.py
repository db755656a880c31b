"""A cascade: its blade with neighbours and layers, its passage, and how large cells are to be there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, complex_of, pairs_of
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.check import check_domain
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_gaps
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.assembly import far_loop
from meshonet.solvers.blocking.cascade.passage import NEAR, Passage
from meshonet.solvers.blocking.layers.layer_rows import LayerSettings, ring_metric
from meshonet.solvers.blocking.layers.rings import Ring, march_ring
from meshonet.solvers.blocking.sizes.size_metric import SizeMetric

THICKNESS, COLUMNS = 0.018, 140
"""Thickness of the layers and cells around the blade, by its length around, where there is room."""
PLAIN_ROWS, PLAIN_GROWTH = 6.0, 1.1
"""Rows in that thickness, and how they grow, where no height of first cells is asked for."""
GAP_PART = 0.25
"""Part of the narrowest gap between blades that layers fill at the most: the channel is not to be a slit."""
_SAMPLES = 400
ACROSS = 12.0
"""Cells in a pitch at the least, where nothing is near, before counts are made up to what was asked for."""
SHORTEST = 0.08
"""Pitches between blade, with its layers, and inlet or outlet at the least."""


@dataclass(frozen=True)
class Cascade:
    """A row of blades.

    Parameters
    ----------
    blade : the passage on its left.
    pitch : vector from a blade to the next.
    inlet, outlet : lengths of the passage before and behind the blade, in axial chords.
    settings : of the layers at the blade; by default a few rows of cells of equal size.
    name : of the blade.
    near : pitches in front of and behind the blade from which straight rows lead on, where there is room.
    centre : of the passage's map, in the blade; by default a point far from its surface.
    """

    blade: Loop
    pitch: tuple[float, float]
    inlet: float = 1.0
    outlet: float = 1.0
    settings: LayerSettings | None = None
    name: str = ""
    near: tuple[float, float] = (NEAR, NEAR)
    centre: complex | None = None

    @property
    def opposite(self) -> bool:
        """Whether the pitch leads to the blade on the right of the flow, which is one of rising x."""
        return self.pitch[1] < 0.0 or (self.pitch[1] == 0.0 and self.pitch[0] > 0.0)

    @property
    def left(self) -> complex:
        """Vector to the next blade on the left of the flow."""
        pitch = complex(*self.pitch)
        return -pitch if self.opposite else pitch

    @property
    def axis(self) -> complex:
        """Unit vector from inlet to outlet."""
        return self.left / (1j * abs(self.left))

    @cached_property
    def chord(self) -> float:
        """Extent of the blade along the axis."""
        return float(np.ptp(self._axial(self.blade)))

    @property
    def extent(self) -> float:
        """The longer one of the passage's length and its pitch."""
        return max((1.0 + self.inlet + self.outlet) * self.chord, abs(self.left))

    def _axial(self, loop: Loop) -> Floats:
        return np.asarray(times(complex_of(loop.curve.points), np.conj(self.axis)).real)

    @cached_property
    def blades(self) -> Domain:
        """The blade and its neighbours on both sides.

        Raises InputError: they cross.
        """
        shift = pairs_of(np.array([-self.left, self.left]))
        curve = self.blade.curve
        beside = [_moved(self.blade, curve, each) for each in shift]
        points = np.concatenate([loop.curve.points for loop in (self.blade, *beside)])
        around = far_loop(points.mean(axis=0), 2.0 * float(np.ptp(points, axis=0).max()))
        try:
            check_domain(Domain((around, self.blade, *beside)))
        except InputError as error:
            problem = f"blades {abs(self.left):g} apart touch or cross"
            raise InputError(problem, "use a larger pitch", parameter="pitch") from error
        return Domain((self.blade, *beside), self.name)

    @cached_property
    def thickness(self) -> float:
        """Thickness of the layers where there is room."""
        arcs = np.linspace(0.0, self.blade.length, _SAMPLES, endpoint=False)
        gap = float(wall_gaps(self.blades, self.blade, arcs).min())
        return min(THICKNESS * self.blade.length, GAP_PART * gap)

    @cached_property
    def layers(self) -> LayerSettings:
        """What the layers around the blade are like."""
        return self.settings or LayerSettings(self.thickness / PLAIN_ROWS, PLAIN_GROWTH)

    @cached_property
    def ring(self) -> Ring:
        """The layers around the blade."""
        largest = self.blade.length / COLUMNS
        return march_ring(self.blades, self.blade, self.layers.first, self.thickness, largest)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Lengths from the front to inlet and outlet."""
        chord, axial = self.chord, self._axial(self.blade)
        around = self._axial(self.ring.front)
        before = self.inlet * chord - float(axial.min() - around.min())
        behind = self.outlet * chord - float(around.max() - axial.max())
        for length, name, chords in ((before, "inlet", self.inlet), (behind, "outlet", self.outlet)):
            least = SHORTEST * abs(self.left)
            if length < least:
                enough = chords + 1.01 * (least - length) / chord
                problem = f"{chords:g} axial chords leave no room for blocks beside the blade"
                raise InputError(problem, f"use {enough:.2g} or more", parameter=name)
        return before, behind

    @cached_property
    def passage(self) -> Passage:
        """The passage around the blade or its layers."""
        front = self.ring.front
        return Passage.around(front, self.left, *self.ends, self.name, self.near, self.centre)

    @cached_property
    def rows_of_layers(self) -> int:
        """Rows of cells in the layers."""
        return self.layers.rows(float(self.ring.thickness.max()))

    @cached_property
    def metric(self) -> SizeMetric:
        """Sizes of cells outside the layers, in the plane of the passage's map."""
        sizes = ring_metric(self.ring, self.layers)
        to = self.passage.map
        points = to.forward(sizes.points)
        turn = to.derivative(points)
        normals = pairs_of(times(complex_of(sizes.normals), turn) / modulus(turn))
        largest = abs(self.left) / ACROSS
        return replace(sizes, points=points, normals=normals, largest=largest, scale=to.stretching)

    def scaled(self, scale: float) -> SizeMetric:
        """Return sizes of cells `scale` times as long along the blade."""
        metric = self.metric
        return replace(metric, along=scale * metric.along, largest=metric.largest * scale**0.5)


def _moved(blade: Loop, curve: Curve, shift: Floats) -> Loop:
    points = curve.points + shift
    return Loop(Curve(points, closed=True, corners=curve.corner_index), blade.corners, blade.names)
