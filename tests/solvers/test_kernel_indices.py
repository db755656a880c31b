"""Kernels refuse indices below the first and beyond the last, whatever they are called with, and say so."""

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from joined_volumes import shell
from surface_shapes import grid_of, plate

import meshonet
from meshonet.geometry.domain.check import crossing_segments
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.volume.hex_mesh import hex_mesh_of
from meshonet.kernels import _native
from meshonet.solvers.energy.hexes import HexProblem
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.smoothing.volume_spacing import wanted_edges

USED = {
    "meshonet.geometry.curves.curve": ("curve_points", "curve_slopes"),
    "meshonet.geometry.layout.quad_mesh": ("connect_quads",),
    "meshonet.solvers.blocking.decomposition.collapse.base_complex": ("split_quads",),
    "meshonet.solvers.refinement.chords": ("joined_classes",),
    "meshonet.solvers.blocking.decomposition.field.frames": ("surface_comb", "surface_prune"),
    "meshonet.solvers.blocking.decomposition.quads.motorcycle": ("probe_rays", "trace_rays"),
    "meshonet.solvers.blocking.decomposition.surface.surface": ("surface_fans",),
    "meshonet.solvers.energy.hexes": ("HexDescent",),
    "meshonet.solvers.energy.quad_problem": ("QuadDescent", "line_neighbours"),
    "meshonet.solvers.hyperbolic.volume.march": ("surface_march", "respace_lines"),
}
"""What kernels with indices are called by."""

OTHERS = {
    "surface_comb": {(2,)},
    "put_rows": {(0,)},
    "probe_rays": {(0, 3)},
    "trace_rays": {(0, 3)},
    "surface_march": {(2, "order")},
}
"""Whole numbers that are no indices: quarter-turns, what only Python reads."""

Place = tuple[int | str, ...]
Call = tuple[Callable[..., Any], tuple[Any, ...]]


def copied(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.copy()
    return tuple(map(copied, value)) if isinstance(value, tuple) else value


def parts(value: Any) -> Iterator[tuple[int | str, Any]]:
    if isinstance(value, tuple):
        yield from enumerate(value)
    elif dataclasses.is_dataclass(value):
        yield from ((field.name, getattr(value, field.name)) for field in dataclasses.fields(value))


def index_arrays(value: Any, place: Place = ()) -> Iterator[Place]:
    """Yield where in arguments there are whole numbers."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "i" and value.size:
        yield place
    for key, part in parts(value):
        yield from index_arrays(part, (*place, key))


def with_number(value: Any, place: Place, number: int) -> Any:
    """Return arguments with another first number in the array at a place."""
    if not place:
        changed = value.copy()
        changed.flat[0] = number
        return changed
    key, *rest = place
    if isinstance(key, str):
        return dataclasses.replace(value, **{key: with_number(getattr(value, key), tuple(rest), number)})
    return tuple(with_number(v, tuple(rest), number) if k == key else v for k, v in enumerate(value))


@pytest.fixture(scope="module")
def calls() -> dict[str, Call]:
    """The first call of every kernel with indices, by what makes grids of blocks and volumes."""
    results: dict[str, Call] = {
        "crossing_segments": (crossing_segments, (np.eye(3, 2), np.arange(3), np.zeros(3), np.ones(3), 9, 9)),
        "put_rows": (
            _native.put_rows,
            (np.empty(99, np.int8), np.ones((1, 2)), b" \n", np.array([0, 0, 1, 2])),
        ),
    }

    def recording(name: str) -> Callable[..., Any]:
        original = getattr(_native, name)

        def call(*given: Any) -> Any:
            results.setdefault(name, (original, copied(given)))
            return original(*given)

        return call

    with pytest.MonkeyPatch.context() as patch:
        for module, names in USED.items():
            for name in names:
                patch.setattr(f"{module}.{name}", recording(name))
        angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        square = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
        meshonet.solve_pde(Domain.of_polygons([square, circle]), cells=300)
        march_surface(surface_of(grid_of(plate(4))), VolumeMarch(1e-2, 5, 0.3))
        mesh = hex_mesh_of(shell(3, 4))
        HexProblem(mesh, ~mesh.outer, wanted_edges(mesh, ~mesh.outer, rounds=0))
    return results


NAMES = sorted({"crossing_segments", "put_rows", *(name for names in USED.values() for name in names)})


@pytest.mark.parametrize("name", NAMES)
def test_indices_below_the_first_and_beyond_the_last_are_refused(calls: dict[str, Call], name: str) -> None:
    kernel, given = calls[name]
    kernel(*copied(given))
    places = set(index_arrays(given)) - OTHERS.get(name, set())
    assert places
    for place in places:
        for wrong in (-2, 10**9):
            with pytest.raises(ValueError, match=r"index|places|starts|brick|cuts|pieces|node"):
                kernel(*with_number(copied(given), place, wrong))
