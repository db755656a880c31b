"""The walls of a grid, the growth of its cells, what a quality profile says of it: as JSON and for people."""

from __future__ import annotations

from typing import Any

from meshonet.formats.mesh.boundary_patches import patches, roles
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.profiles import Checked, Figures, Judgement, Limit
from meshonet.geometry.quality.walls import Spread, WallRow
from meshonet_cli.report import aligned, figure


def walls(grid: Grid) -> list[Patch]:
    """Return the stretches of wall of `grid`, told by their names; south and north of a quad without."""
    stretches = patches(grid)
    known = roles(grid, stretches)
    found = [part for part in stretches if known[part.name] == "wall"]
    if found or grid.topology != "quad" or "wall" in known.values():
        return found
    return [part for part in stretches if part.side in ("south", "north") and known[part.name] == "other"]


def walls_json(rows: tuple[WallRow, ...]) -> list[dict[str, Any]]:
    """Return the cells at the walls as JSON."""
    return [
        {
            "name": row.name,
            "side": row.side,
            "first_cell": vars(row.height),
            "off_square": vars(row.off_square),
            "equal_cells": row.equal_cells,
        }
        for row in rows
    ]


def judgement_json(figures: Figures, judgement: Judgement) -> dict[str, Any]:
    """Return a judgement, and the growth that belongs to it, as JSON."""
    return {
        "growth": {"xi": _extreme_json(figures.growth.xi), "eta": _extreme_json(figures.growth.eta)},
        "profile": {
            "name": judgement.profile,
            "passed": judgement.passed,
            "checks": [_checked_json(checked) for checked in judgement.checked],
        },
    }


def _checked_json(checked: Checked) -> dict[str, Any]:
    return {
        "figure": checked.check.figure,
        "value": checked.value,
        "at": list(checked.at) if checked.at else None,
        "limits": [{"level": x.level, "when": x.compare, "value": x.value} for x in checked.check.limits],
        "verdict": checked.verdict,
    }


def _extreme_json(extreme: Extreme | None) -> dict[str, Any] | None:
    return None if extreme is None else {"max": extreme.max, "mean": extreme.mean, "at": list(extreme.at)}


def walls_table(rows: tuple[WallRow, ...]) -> str:
    """Return the cells at the walls as a table for people."""
    head = ["at the walls", "min", "mean", "max", "equal cells"]
    table = [head]
    for row in rows:
        table.append([f"{row.name}: first cell", *_spread(row.height), str(row.equal_cells)])
        table.append([f"{row.name}: off 90 (deg)", *_spread(row.off_square), ""])
    return aligned(table)


def judgement_table(figures: Figures, judgement: Judgement) -> str:
    """Return a judgement, and the growth that belongs to it, as a table for people."""
    rows = [["growth", "mean", "max", "at i, j"]]
    for name, extreme in (("along xi", figures.growth.xi), ("along eta", figures.growth.eta)):
        if extreme:
            place = "{}, {}".format(*extreme.at)
            rows.append([name, figure(extreme.mean), figure(extreme.max), place])
    checks = [[f"profile {judgement.profile}", "figure", "at i, j", "limits", "verdict"]]
    checks += [_checked_row(checked) for checked in judgement.checked]
    return f"{aligned(rows)}\n{aligned(checks)}"


def _checked_row(checked: Checked) -> list[str]:
    value = "-" if checked.value is None else figure(checked.value)
    place = "{}, {}".format(*checked.at) if checked.at else ""
    limits = ", ".join(limit_text(limit) for limit in checked.check.limits)
    verdict = {"fail": "FAIL", "warn": "warning", "none": "no figure"}.get(checked.verdict, checked.verdict)
    return [checked.check.figure, value, place, limits, verdict]


def limit_text(limit: Limit) -> str:
    """Return a limit for people.

    Examples
    --------
    >>> limit_text(Limit("fail", ">=", 90))
    'fail >= 90'
    """
    return f"{limit.level} {limit.compare} {limit.value:g}"


def problems(judgement: Judgement) -> list[str]:
    """Return a line for each check that failed."""
    return [
        f"profile {judgement.profile}: {checked.check.figure} is {checked.value:.6g}, and it must "
        + " nor ".join(f"not be {x.compare} {x.value:g}" for x in checked.check.limits if x.level == "fail")
        for checked in judgement.checked
        if checked.verdict == "fail" and checked.value is not None
    ]


def _spread(spread: Spread) -> list[str]:
    return [figure(value) for value in (spread.min, spread.mean, spread.max)]
