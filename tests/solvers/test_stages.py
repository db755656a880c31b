"""Stages of solvers, for whoever watches."""

import numpy as np
from surface_shapes import grid_of, sphere

from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.surface.surface import surface_of
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.stages import Stage, filling, reached, watching


def test_a_grid_goes_through_its_stages() -> None:
    seen: list[Stage] = []
    with watching(seen.append):
        result = make_grid(naca("0012"), GridRequest(Sampling(60, 40), "winslow"))
    names = [stage.name for stage in seen]
    assert names == ["boundary", "grid", "guard", "quality"]
    assert set(names) <= set(result.seconds) | {"load"}


def test_levels_of_a_march_are_counted_and_stay_as_they_are() -> None:
    seen: list[Stage] = []
    surface, settings = surface_of(grid_of(sphere(8))), VolumeMarch(1e-2, 12, 4.0)
    with watching(seen.append):
        watched = march_surface(surface, settings)
    counted = next(stage for stage in seen if stage.count)
    assert (counted.name, counted.unit, counted.count, counted.done()) == ("grid", "level", 11, 11)
    for one, other in zip(watched.grid.blocks, march_surface(surface, settings).grid.blocks, strict=True):
        np.testing.assert_array_equal(one.nodes, other.nodes)


def test_rows_of_a_march_are_counted_and_stay_as_they_are() -> None:
    seen: list[Stage] = []
    request = GridRequest(Sampling(80, 30), "hyperbolic", first_cell=1e-3)
    with watching(seen.append):
        watched = make_grid(naca("0012"), request).grid
    counted = next(stage for stage in seen if stage.count)
    assert (counted.unit, counted.done()) == ("row", counted.count)
    np.testing.assert_array_equal(watched.nodes, make_grid(naca("0012"), request).grid.nodes)


def test_marks_are_counted_as_they_are_overwritten() -> None:
    seen: list[Stage] = []
    marks = np.ones(3)
    with watching(seen.append), filling("grid", "level", marks):
        assert seen[0].done() == 0
        marks[0] = 0.5
        assert seen[0].done() == 1
    assert (seen[-1].name, seen[-1].count) == ("grid", 0)


def test_nobody_watches_outside_the_block() -> None:
    seen: list[Stage] = []
    marks = np.ones(3)
    with watching(seen.append):
        pass
    reached("grid", "cycle", 3)
    with filling("grid", "level", marks):
        assert marks.min() == 1.0  # kernels then find what was there
    assert not seen
