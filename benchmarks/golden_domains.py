"""Folds and angles of 500 random four-sided domains and of a folder of airfoil files, by several methods.

figures = {label: figures_of(run) for label, run in ...}
for line in differing(before, after): print(line)
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from golden_runs import Run

ANGLE_TOLERANCE = 1e-6
SAMPLED = "sample-boundary --family four-sided --count 500 --seed 77 --res 33 -> five-hundred.h5"
WAYS = (
    "solve-pde {} --method variational",
    "solve-pde {} --method winslow --allow-invalid --no-repair",
    "infer {}",
)
NETWORKS = {"domains": "infer {} --model quad-general", "airfoils": "infer {} --model airfoil-o"}
SHOWN = 5
"""Grids of a run that are shown one by one when they differ."""

Figures = list[list[float]]
"""Folded cells, largest and mean angle in degrees of each grid; of one that failed the exit code alone."""


def domain_lines(airfoils: Sequence[str]) -> dict[str, str]:
    """Return the commands by label; `airfoils` are the names of files, maybe none."""
    sources = {"domains": "made/five-hundred.h5"}
    if airfoils:
        sources["airfoils"] = " ".join(airfoils) + " --res 129x65 --topology o"
    return {
        way.format(kind): f"{way.format(source)} --json"
        for kind, source in sources.items()
        for way in (*WAYS, NETWORKS[kind])
    }


def airfoil_names(folder: Path) -> list[str]:
    """Return the airfoil files of a folder, none where there is no such folder."""
    return sorted(path.name for path in folder.glob("*.dat"))


def figures_of(run: Run) -> Figures:
    """Return the figures of every grid that a command tells of."""
    answers = [json.loads(line) for line in run.stream("stdout").splitlines()]
    return [[one["exit_code"]] if "error" in one else _figures(one) for one in answers]


def _figures(answer: Mapping[str, Mapping[str, Mapping[str, float]]]) -> list[float]:
    angle = answer["quality"]["max_angle"]
    return [float(str(answer["folded"])), angle["max"], angle["mean"]]


def summary(label: str, figures: Figures) -> str:
    """Return one line about the grids of a command."""
    made = [row for row in figures if len(row) == 3]
    if not made:
        return f"{label}: no grid of {len(figures)}"
    folded, largest, mean = zip(*made, strict=True)
    return (
        f"{label}: {len(made)} grids of {len(figures)}, {sum(k > 0 for k in folded)} of them folded in "
        f"{sum(folded):.0f} cells, largest angle {max(largest):.3f}, mean {sum(mean) / len(made):.4f}"
    )


def differing(before: Figures, after: Figures) -> Iterator[str]:
    """Yield what differs between the grids of one command: folds at all, angles beyond `ANGLE_TOLERANCE`."""
    if len(before) != len(after):
        yield f"{len(before)} grids became {len(after)}"
        return
    pairs = [
        (k, old, new) for k, (old, new) in enumerate(zip(before, after, strict=True)) if not _alike(old, new)
    ]
    for k, old, new in pairs[:SHOWN]:
        yield f"grid {k}: {old} became {new}"
    if len(pairs) > SHOWN:
        yield f"and {len(pairs) - SHOWN} grids more"


def _alike(old: Sequence[float], new: Sequence[float]) -> bool:
    if len(old) != len(new) or old[0] != new[0]:
        return False
    return all(abs(b - a) <= ANGLE_TOLERANCE * abs(a) for a, b in zip(old[1:], new[1:], strict=True))
