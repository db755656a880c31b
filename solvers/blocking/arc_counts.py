"""Whole numbers nearest to wanted ones under sums that must be equal: cells of arcs and of chords.

The integers are those of arcs of a T-mesh rather than of coordinates of the map (Campen, Bommes, Kobbelt, ACM
Trans. Graph. 34 (2015) 192; Lyon, Campen, Bommes, Kobbelt, Comput. Graph. Forum 38 (2019) 21-32). The programme
is solved by HiGHS (Huangfu, Hall, Math. Program. Comput. 10 (2018) 119-142).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.errors import BlockingError
from meshonet.solvers.blocking.t_mesh import TMesh

GAP = 0.02
"""A solution is good enough when it is known to be so close to the best, as a part of its cost."""
NODES, SECONDS = 2000, 10.0
LOOP = 4
"""Cells along a closed wall, at least."""

Row = tuple[Mapping[int, float], float, float]
"""Coefficients of some numbers, and the least and greatest that their sum may be."""


def arc_counts(mesh: TMesh, wanted: Floats, equal: Sequence[tuple[Sequence[int], Sequence[int]]] = ()) -> Indices:
    """Return cells (a,) along each arc, at least 1, near the `wanted` (a,), alike on opposite sides of faces.

    Parameters
    ----------
    mesh : its faces are rectangles of the map, so the lengths of arcs in the map, scaled, satisfy all rows.
    wanted : cells, any positive numbers.
    equal : pairs of runs of arcs that have equally many cells, as both sides of a period.

    Raises BlockingError: no whole numbers found.
    """
    pairs = [pair for face in mesh.faces for pair in ((face[0], face[2]), (face[1], face[3]))]
    arcs = [tuple([half // 2 for half in side] for side in pair) for pair in pairs]
    rows = [_balance(*pair) for pair in [*arcs, *equal]]
    loops = mesh.on_wall
    for trail in sorted(set(mesh.trail[loops >= 0].tolist())):
        rows.append((dict.fromkeys(np.flatnonzero(mesh.trail == trail).tolist(), 1.0), LOOP, np.inf))
    return nearest_whole(wanted, np.ones(len(wanted)), [row for row in rows if row[0]])


def _balance(first: Sequence[int], second: Sequence[int]) -> Row:
    """Return the row that says that the sums of two runs are equal; what is in both cancels."""
    row: dict[int, float] = {}
    for run, sign in ((first, 1.0), (second, -1.0)):
        for arc in run:
            row[arc] = row.get(arc, 0.0) + sign
    return {arc: value for arc, value in row.items() if value}, 0.0, 0.0


def nearest_whole(wanted: Floats, least: Floats, rows: Sequence[Row]) -> Indices:
    """Return whole numbers n (k,) at least `least` (k,) that keep the rows, sum |n - wanted| / wanted smallest.

    Raises BlockingError: there are none, or none was found in time.
    """
    solver = _solver()
    count = len(wanted)
    if not count:
        return np.zeros(0, dtype=np.intp)
    solver.passModel(_model(wanted, least, rows))
    solver.run()
    steps = np.array(solver.getSolution().col_value[: 3 * count])
    if len(steps) != 3 * count or solver.getInfo().primal_solution_status != 2:
        raise BlockingError("no whole numbers of cells keep opposite sides alike")
    up, beyond, below = np.round(steps).astype(np.intp).reshape(3, count)
    whole = np.maximum(least, np.floor(wanted)).astype(np.intp) + up + beyond - below
    for row, low, high in rows:
        total = sum(value * whole[k] for k, value in row.items())
        if not low - 1e-6 <= total <= high + 1e-6:
            raise BlockingError("numbers of cells found are not alike on opposite sides")
    return whole


def _solver() -> Any:
    from highspy import Highs

    solver = Highs()
    options = {
        "output_flag": False,
        "threads": 1,
        "random_seed": 0,
        "mip_rel_gap": GAP,
        "mip_max_nodes": NODES,
        "time_limit": SECONDS,
    }
    for name, value in options.items():
        solver.setOptionValue(name, value)
    return solver


def _model(wanted: Floats, least: Floats, rows: Sequence[Row]) -> Any:
    """Return the programme in steps from base = max(least, whole part of wanted): n = base + s + p - m.

    s, at most 1, is the step over the wanted number, p and m are those beyond and below. The cost is then linear
    between whole numbers and not below them, and relaxed solutions are whole, or nearly: each arc is in two
    rows with coefficients +-1 (a bidirected network, whose corners are half-integral).
    """
    from highspy import HighsLp, HighsVarType, MatrixFormat

    count, inf = len(wanted), float("inf")
    base = np.maximum(least, np.floor(wanted))
    over = np.clip(wanted - base, 0.0, 1.0)
    weight = 1.0 / np.maximum(wanted, 0.5)
    lp = HighsLp()
    lp.num_col_, lp.num_row_ = 3 * count, len(rows)
    lp.col_cost_ = np.concatenate([weight * (1.0 - 2.0 * over), weight, weight])
    lp.col_lower_ = np.zeros(3 * count)
    lp.col_upper_ = np.concatenate([np.ones(count), np.full(count, inf), base - least])
    index = [k + block * count for row, _, _ in rows for block in range(3) for k in row]
    value = [sign * v for row, _, _ in rows for sign in (1.0, 1.0, -1.0) for v in row.values()]
    shift = np.array([sum(v * base[k] for k, v in row.items()) for row, _, _ in rows])
    lp.row_lower_ = np.array([row[1] for row in rows]) - shift
    lp.row_upper_ = np.array([row[2] for row in rows]) - shift
    matrix = lp.a_matrix_
    matrix.format_ = MatrixFormat.kRowwise
    matrix.start_ = np.append(0, np.cumsum([3 * len(row) for row, _, _ in rows])).astype(np.int32)
    matrix.index_ = np.array(index, dtype=np.int32)
    matrix.value_ = np.array(value, dtype=np.float64)
    lp.integrality_ = [HighsVarType.kInteger] * (3 * count)
    return lp
