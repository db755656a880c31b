"""Integers closest to given numbers under linear constraints: cells of arcs, chords and edges of faces.

The integer programme is solved by HiGHS (Huangfu, Hall, Math. Program. Comput. 10 (2018) 119-142).
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import SolverError
from meshonet.geometry.ties import made_unlike, nearest_whole

OPTIONS: dict[str, bool | int | float | str] = {
    "output_flag": False,
    "threads": 1,
    "random_seed": 0,
    "presolve": "off",
    "mip_rel_gap": 0.02,
    "mip_max_nodes": 2000,
}
"""Options of HiGHS: one thread, a fixed seed and no time limit, so that results are reproducible."""
STEPS = (1.0, 1.05, 1.1, 1.2, 1.4, 1.6, 2.0, 2.0, np.inf)  # factors of each step up or down, by at least 1
Row = tuple[Mapping[int, float], float, float]
"""Coefficients of a sum of numbers, and its lower and upper bound."""


def difference(first: Iterable[int], second: Iterable[int], low: float = 0.0, high: float = 0.0) -> Row:
    """Return the constraint ``low <= sum(x[i], i in first) - sum(x[i], i in second) <= high``."""
    row: dict[int, float] = {}
    for run, sign in ((first, 1.0), (second, -1.0)):
        for number in run:
            row[number] = row.get(number, 0.0) + sign
    return {number: value for number, value in row.items() if value}, low, high


def whole_numbers(wanted: Floats, least: Floats, rows: Sequence[Row]) -> Indices:
    """Return integers n (k,) that are at least `least` (k,), near `wanted` (k,), and satisfy constraints.

    The integers minimise the sum of n / wanted + wanted / n, which is nearly the sum of the squares of
    log(n / wanted). `rows` are the constraints. Raises SolverError if there is no solution or none was found.
    """
    if not len(wanted):
        return np.zeros(0, dtype=np.intp)
    steps = _steps(wanted, least)
    solution = _solved(_model(steps, rows), steps[2])
    moved = product(steps[1], solution)
    whole = np.round(steps[0] + moved).astype(np.intp)
    for row, low, high in rows:
        total = sum(value * whole[k] for k, value in row.items())
        if not low - 1e-6 <= total <= high + 1e-6:
            raise SolverError("numbers of cells found are not alike on opposite sides")
    return whole


def _solved(programme: Any, lengths: Floats) -> Floats:
    """Return the steps (b, k) taken; those of the relaxed programme are mostly whole."""
    from highspy import Highs, HighsVarType

    solver: Any = Highs()  # type: ignore[no-untyped-call]
    for name, value in OPTIONS.items():
        solver.setOptionValue(name, value)
    for whole in (False, True):
        programme.integrality_ = [HighsVarType.kInteger] * lengths.size if whole else []
        solver.passModel(programme)
        solver.run()
        solution = np.array(solver.getSolution().col_value)
        if len(solution) != lengths.size or solver.getInfo().primal_solution_status != 2:
            break
        if np.abs(solution - np.round(solution)).max() < 1e-6:
            return np.round(solution).reshape(lengths.shape)
    raise SolverError("no whole numbers of cells keep opposite sides alike")


def _steps(wanted: Floats, least: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return where steps start from (k,), and their signs (b,), lengths (b, k) and costs (b, k)."""
    size = np.maximum(wanted, 0.5)

    def cost(n: Floats) -> Floats:
        return np.asarray(n / size + size / np.maximum(n, 0.5))

    base = np.maximum(least, nearest_whole(wanted))
    signs, lengths, costs = [], [], []
    for sign in (1.0, -1.0):
        at = base
        for factor in STEPS:
            ends = np.isinf(factor)
            times = 2.0 if ends else factor
            to = nearest_whole(at * times if sign > 0 else at / times)
            to = np.maximum(least, np.maximum(to, at + 1.0) if sign > 0 else np.minimum(to, at - 1.0))
            if ends and sign < 0:
                to = least
            far = np.abs(to - at)
            rise = np.divide(cost(to) - cost(at), far, out=np.zeros(len(base)), where=far > 0)
            signs.append(sign)
            lengths.append(np.full(len(base), np.inf) if ends and sign > 0 else far)
            costs.append(rise)
            at = to
    return base, np.array(signs), np.array(lengths), made_unlike(np.array(costs))


def _model(steps: tuple[Floats, Floats, Floats, Floats], rows: Sequence[Row]) -> Any:
    """Return the programme in steps, each dearer than the one before: n = base + up - down.

    Costs are linear between integers. Relaxed solutions are nearly whole, as each arc is in two rows with
    +-1.
    """
    from highspy import HighsLp, MatrixFormat

    base, signs, lengths, costs = steps
    blocks, count = lengths.shape
    lp = HighsLp()
    lp.num_col_, lp.num_row_ = lengths.size, len(rows)
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = costs.ravel(), np.zeros(lengths.size), lengths.ravel()
    sizes = np.array([len(row) for row, _, _ in rows], dtype=np.intp)
    index = np.array([k for row, _, _ in rows for k in row], dtype=np.intp)
    value = np.array([v for row, _, _ in rows for v in row.values()])
    line = np.repeat(np.arange(len(rows)), sizes)
    shift = np.bincount(line, value * base[index], minlength=len(rows))
    lp.row_lower_ = np.array([row[1] for row in rows]) - shift
    lp.row_upper_ = np.array([row[2] for row in rows]) - shift
    matrix = lp.a_matrix_
    matrix.format_ = MatrixFormat.kRowwise
    matrix.start_ = np.append(0, np.cumsum(blocks * sizes)).astype(np.int32)
    # a row has all blocks of its first number, then of its second
    matrix.index_ = (index[:, None] + count * np.arange(blocks)).ravel().astype(np.int32)
    matrix.value_ = (value[:, None] * signs).ravel()
    return lp
