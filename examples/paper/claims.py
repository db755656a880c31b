"""Which of the paper's claims the results confirm, in words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from statistics import mean

import words
from results import (
    BASELINES,
    FAMILIES,
    RACERS,
    SPLITS,
    finished,
    one,
    raced,
    read_log,
    summary,
    table,
)

ORDERS = 10.0
"""How many times MeshONet's loss that of a baseline is at least, if it is orders of magnitude below."""
SAME = 0.1
"""Degrees by which means of largest angles may differ that count as equal."""
CLAIMED = {
    ("arch", "interpolation"): ("below", "below"),
    ("arch", "extrapolation"): ("below", "below"),
    ("hexagon", "interpolation"): ("below", "below"),
    ("hexagon", "extrapolation"): ("below", "below"),
    ("wrench", "interpolation"): ("equal", "below"),
    ("wrench", "extrapolation"): ("above", "below"),
    ("airfoil", "interpolation"): ("below", "equal"),
    ("airfoil", "extrapolation"): ("below", "above"),
    ("hole", "random"): ("below", "below"),
}
"""The paper's words on quality as largest angles against those of TFI and of the PDE solver."""


def lowest(results: Path) -> str:
    """Return whether MeshONet's loss is orders of magnitude below that of its baselines, case by case."""
    sentences = []
    for case in raced(results):
        logs = {name: finished(results, case, name) for name in RACERS if name != "meshonet-hard"}
        last = {name: [read_log(path)[-1]["mean_square"] for path in result] for name, result in logs.items()}
        last = {name: result for name, result in last.items() if result}
        if "meshonet" not in last:
            continue
        sentences.append(_on_loss(case, {name: mean(result) for name, result in last.items()}))
    return words.LOWEST + "\n\n".join(sentences) if sentences else ""


def _on_loss(case: str, means: Mapping[str, float]) -> str:
    """Return the verdict on a case, and how many baselines have a lower loss than MeshONet."""
    ratios = {name: loss / means["meshonet"] for name, loss in means.items()}
    known = [name for name in BASELINES if name in ratios]
    below = [name for name in known if ratios[name] < 1.0]
    verdict = "confirmed" if known and min(ratios[name] for name in known) >= ORDERS else "not confirmed"
    text = f"**Loss: {verdict} on this budget** (case {case}). "
    if below:
        text += f"{len(below)} of {len(known)} baselines have a lower loss than MeshONet. "
    else:
        text += f"MeshONet's loss is the lowest of {len(known) + 1}. "
    times = ", ".join(f"{ratios[name]:.2g} (`{name}`)" for name in known)
    return f"{text}The losses of the baselines are {times} times MeshONet's."


def quality_claims(results: Path) -> str:
    """Return what the largest angles say of the paper's claims about quality, a row a case and split."""
    rows, raw, folded = [], 0, 0
    for case in ((family, split) for family in FAMILIES for split in SPLITS):
        ways = ("tfi", "pde", "meshonet.pasted")
        summaries = {way: summary(results / f"{'.'.join(case)}.{way}.json") for way in ways}
        if not all(summaries.values()):
            continue
        angles = {way: each["max_angle"]["mean"] for way, each in summaries.items()}
        compared = tuple(_compared(angles["meshonet.pasted"], angles[way]) for way in ("tfi", "pde"))
        own = summary(results / f"{'.'.join(case)}.meshonet.raw.json")
        raw += bool(own) and own["max_angle"]["mean"] < min(angles["tfi"], angles["pde"]) - SAME
        folded += summaries["meshonet.pasted"]["folded"]["sum"] > 0
        claim = CLAIMED.get(case)
        cells = ["-", "-"] if claim is None else [" / ".join(claim), "yes" if claim == compared else "no"]
        rows.append([*case, " / ".join(compared), *cells])
    if not rows:
        return ""
    head = ["case", "split", "measured, against TFI / PDE", "claimed, against TFI / PDE", "confirmed"]
    stated, right = (sum(row[4] in words for row in rows) for words in (("yes", "no"), ("yes",)))
    verdict = (
        "confirmed"
        if right == stated
        else f"confirmed in {right} of {stated} cases"
        if right
        else "not confirmed"
    )
    below = [sum(row[2].split(" / ")[k] == "below" for row in rows) for k in (0, 1)]
    text = (
        f"**Quality: {verdict}.** MeshONet's largest angle is below TFI's in {below[0]} of {len(rows)} "
        f"cases, and below the PDE solver's in {below[1]}. The pasted boundary folds cells in {folded} of "
        f"{len(rows)} cases. If the network keeps its own boundary nodes, the largest angle is below TFI's "
        f"and the PDE solver's in {raw} of {len(rows)} cases, but such grids miss the given boundary."
    )
    return f"{words.CLAIMS}\n{text}\n\n{table(head, rows)}"


def _compared(own: float, other: float) -> str:
    if abs(own - other) <= SAME:
        return "equal"
    return "below" if own < other else "above"


def speed_claims(results: Path) -> str:
    """Return how many times MeshONet's time the PDE solver takes."""
    ratios = []
    for path in sorted(results.glob("time.meshonet.*.json")):
        own, pde = one(path), one(results / path.name.replace("meshonet", "pde"))
        if own and pde:
            ratios.append(pde["seconds"]["grid"] / own["seconds"]["grid"])
    if not ratios:
        return ""
    return words.SPEED.format(times=f"{min(ratios):.2g} to {max(ratios):.2g}")
