"""What meshonet wrote in PAGES/results, and a table of it in Markdown."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

FAMILIES = ("arch", "hexagon", "wrench", "semicircle", "airfoil", "hole")
SPLITS = ("interpolation", "extrapolation", "random")
RACERS = (
    "meshonet", "meshonet-hard", "deeponet", "pod-deeponet", "fno1d", "fno2d", "wno", "kno", "lno", "mionet",
)  # fmt: skip
BASELINES = ("deeponet", "pod-deeponet", "fno1d", "fno2d")
NEWER = ("wno", "kno", "lno")


def finished(results: Path, case: str, model: str) -> list[Path]:
    """Return the logs of the runs of a model that have been evaluated."""
    logs = sorted(results.glob(f"{case}.{model}.race*.csv"))
    return [log for log in logs if log.with_suffix(".json").exists()]


def raced(results: Path) -> list[str]:
    """Return the cases of which there are races."""
    return sorted({path.name.rsplit(".", 2)[0].rsplit(".", 1)[0] for path in results.glob("*.race*.json")})


def read_log(path: Path) -> list[dict[str, float]]:
    """Return the rows of a log; ``mean_square`` weighs the parts of the loss as the baselines do."""
    weights = {"interior": 1.0, "boundary": 1.0}
    if ".meshonet.race" in path.name:
        weights = {"interior": 1 / 900.0, "boundary": 1 / 1000.0}
    with path.open(encoding="utf-8") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    for row in rows:
        row["mean_square"] = sum(row[part] * weights[part] for part in weights if part in row)
    return rows


def summary(path: Path) -> dict[str, Any]:
    """Return a summary that `quality --summary --json` wrote, nothing when there is none."""
    return one(path).get("summary", {})


def one(path: Path) -> dict[str, Any]:
    """Return the JSON object of a file, nothing when there is none."""
    if not path.exists() or not path.read_text(encoding="utf-8").strip():
        return {}
    report: dict[str, Any] = json.loads(path.read_text(encoding="utf-8").splitlines()[-1])
    return report


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
