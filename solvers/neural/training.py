"""Training of the strip operator, read from top to bottom.

Targets are coefficients of R / size^2 in a basis across the strip that is best for the training set in the H1
sense (proper orthogonal decomposition), so that angles count and not only positions.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

from geometry.arrays import Complexes, Floats
from geometry.errors import InputError, SolverError
from solvers.neural.dataset import Strips
from solvers.neural.encoding import CHANNELS, SCALARS, VERSION, decode, encode
from solvers.neural.models.strip_fno import StripFNO
from solvers.neural.strip import across, picard, to_columns
from solvers.neural.weights import KIND


@dataclass(frozen=True)
class Settings:
    """What a run is made of; the same settings, data and machine give the same weights.

    `held_out` strips from the end are never trained on. `warm_up` counts steps.
    """

    epochs: int = 60
    batch: int = 32
    rate: float = 2e-3
    warm_up: int = 100
    basis: int = 16
    width: int = 48
    modes: int = 40
    layers: int = 3
    held_out: int = 300
    seed: int = 0
    checkpoint_every: int = 1
    threads: int = 1


@dataclass(frozen=True)
class Report:
    """One epoch: loss on the training set, relative errors of R on the held-out strips."""

    epoch: int
    loss: float
    median: float
    p90: float
    worst: float
    rate: float
    seconds: float


def train(
    strips: Strips,
    output: Path,
    settings: Settings,
    *,
    name: str,
    recipe: Mapping[str, Any],
    resume: bool = False,
    report: Callable[[Report], None] | None = None,
) -> dict[str, Any]:
    """Fit a StripFNO and write it to `output` with its recipe and held-out figures; return the figures.

    A checkpoint stands beside `output` (``.checkpoint``) after every `checkpoint_every` epochs and is removed
    at the end; `resume` starts from it.

    Raises
    ------
    InputError
        fewer strips than are held out; a checkpoint of other settings.
    SolverError
        a loss that is not finite; the last checkpoint stays.
    """
    if len(strips) < settings.held_out + settings.batch:
        raise InputError(f"{len(strips)} strips, {settings.held_out} held out", "give more shapes")
    torch.manual_seed(settings.seed)
    torch.set_num_threads(settings.threads)
    kept = len(strips) - settings.held_out
    test = Strips(strips.wall[kept:], strips.far[kept:], strips.residual[kept:])
    data = _doubled(Strips(strips.wall[:kept], strips.far[:kept], strips.residual[:kept]))
    channels, scalars, size = (torch.tensor(a, dtype=torch.float32) for a in encode(data.wall, data.far))
    target = _unit_residual(data, size.numpy())
    basis, weight = _basis(target, settings.basis)
    coefficients = _project(target, basis, weight)
    scale = float(np.sqrt((coefficients**2).sum(axis=1).mean()))
    wanted = torch.tensor(coefficients / scale, dtype=torch.float32)
    importance = 1.0 / ((wanted**2).sum(1).mean(1) + 0.03) ** 0.75  # small answers count too

    net = StripFNO(CHANNELS, SCALARS, 2 * settings.basis, settings.width, settings.modes, settings.layers)
    optimiser = torch.optim.AdamW(net.parameters(), settings.rate, weight_decay=1e-4)
    checkpoint = output.with_name(output.name + ".checkpoint")
    first = _restore(checkpoint, net, optimiser, settings) if resume else 0
    steps = settings.epochs * -(-len(wanted) // settings.batch)
    done = first * -(-len(wanted) // settings.batch)
    for epoch in range(first, settings.epochs):
        begun, total = time.perf_counter(), 0.0
        order = torch.randperm(
            len(wanted), generator=torch.Generator().manual_seed(1_000_003 * settings.seed + epoch)
        )
        for rows in order.split(settings.batch):
            done += 1
            rate = (
                settings.rate * min(1.0, done / settings.warm_up) * 0.5 * (1.0 + np.cos(np.pi * done / steps))
                + 1e-6
            )
            for group in optimiser.param_groups:
                group["lr"] = rate
            error = net(channels[rows], scalars[rows]) - wanted[rows]
            loss = (importance[rows] * (error**2).sum(1).mean(1)).mean()
            if not torch.isfinite(loss):
                raise SolverError(f"the loss is not finite in epoch {epoch + 1}; lower the rate and --resume")
            optimiser.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
            optimiser.step()
            total += loss.item() * len(rows)
        errors = _relative_errors(net, test, basis, scale)
        median, p90, worst = (float(q) for q in np.quantile(errors, [0.5, 0.9, 1.0]))
        if report is not None:
            report(
                Report(epoch + 1, total / len(wanted), median, p90, worst, rate, time.perf_counter() - begun)
            )
        if (epoch + 1) % settings.checkpoint_every == 0:
            _save(checkpoint, net, optimiser, settings, epoch + 1)
    figures = held_out_figures(net, test, basis, scale)
    _write(output, net, basis, scale, name, {**recipe, **asdict(settings), "strips": len(strips)}, figures)
    checkpoint.unlink(missing_ok=True)
    return figures


def held_out_figures(net: StripFNO, test: Strips, basis: Floats, scale: float) -> dict[str, Any]:
    """Return quantiles of ||found - R|| / ||R|| over held-out strips, network and base beside each other."""
    answers = _answers(net, test, basis, scale)
    figures: dict[str, Any] = {
        "strips": len(test),
        "error": "||R found - R|| / ||R|| at the Chebyshev points",
    }
    ways: dict[str, list[float]] = {
        "base + 1 Picard": [],
        "base + 2 Picard": [],
        "network": [],
        "network + 1 Picard": [],
    }
    for m in range(len(test)):
        start = _harmonic_of(test, m)
        goal = test.residual[m]
        ways["base + 1 Picard"].append(_miss(picard(start, 1)[0] - start, goal))
        ways["base + 2 Picard"].append(_miss(picard(start, 2)[0] - start, goal))
        ways["network"].append(_miss(answers[m], goal))
        ways["network + 1 Picard"].append(_miss(picard(start + answers[m], 1)[0] - start, goal))
    figures["base"] = {"median": 1.0, "p90": 1.0, "worst": 1.0}
    for way, values in ways.items():
        quantiles = np.quantile(values, [0.5, 0.9, 1.0])
        figures[way] = {
            key: round(float(q), 6) for key, q in zip(("median", "p90", "worst"), quantiles, strict=True)
        }
    return figures


def _harmonic_of(strips: Strips, m: int) -> Complexes:
    from solvers.neural.strip import harmonic

    return harmonic(strips.wall[m], strips.far[m], across().eta)


def _doubled(strips: Strips) -> Strips:
    """Return the strips and their mirror images."""
    other = strips.mirrored()
    pairs = ((strips.wall, other.wall), (strips.far, other.far), (strips.residual, other.residual))
    return Strips(*(np.concatenate(pair) for pair in pairs))


def _unit_residual(strips: Strips, size: Floats) -> Complexes:
    """Return R / size^2 (n, COLUMNS, LEVELS - 2) at the inner points."""
    columns = np.array([to_columns(r) for r in strips.residual])
    return np.asarray(columns[:, :, 1:-1] / (size**2)[:, None, None])


def _basis(target: Complexes, count: int) -> tuple[Floats, Floats]:
    """Return (count, LEVELS - 2) functions, orthonormal in the H1 product, and that product's matrix."""
    grid = across()
    quadrature = np.gradient(grid.eta)
    derivative = grid.d1[:, 1:-1] / 4.0  # lengths across count in units of the strip's height, about 4
    product = np.diag(quadrature[1:-1]) + derivative.T @ (quadrature[:, None] * derivative)
    rows = target[:, ::4].reshape(-1, target.shape[2])
    gram = (rows.real.T @ rows.real + rows.imag.T @ rows.imag).astype(np.float64)
    root = np.linalg.cholesky(product)
    _, vectors = np.linalg.eigh(root.T @ gram @ root)
    return np.linalg.solve(root.T, vectors[:, ::-1][:, :count]).T, product


def _project(target: Complexes, basis: Floats, product: Floats) -> Floats:
    """Return (n, 2 Q, COLUMNS) coefficients of the target in the basis."""
    c = np.einsum("nxe,eq->nqx", target, product @ basis.T)
    return np.concatenate([c.real, c.imag], axis=1)


def _answers(net: StripFNO, strips: Strips, basis: Floats, scale: float) -> list[Complexes]:
    channels, scalars, size = encode(strips.wall, strips.far)
    with torch.no_grad():
        out = net(
            torch.tensor(channels, dtype=torch.float32), torch.tensor(scalars, dtype=torch.float32)
        ).numpy()
    return [decode(out[m].astype(np.float64), basis, scale, float(size[m])) for m in range(len(strips))]


def _relative_errors(net: StripFNO, strips: Strips, basis: Floats, scale: float) -> Floats:
    pairs = zip(_answers(net, strips, basis, scale), strips.residual, strict=True)
    return np.array([_miss(found, goal) for found, goal in pairs])


def _miss(found: Complexes, goal: Complexes) -> float:
    return float(np.linalg.norm(found - goal) / np.linalg.norm(goal))


def _save(
    path: Path, net: StripFNO, optimiser: torch.optim.Optimizer, settings: Settings, epoch: int
) -> None:
    part = path.with_name(path.name + ".part")
    torch.save(
        {
            "net": net.state_dict(),
            "optimiser": optimiser.state_dict(),
            "settings": asdict(settings),
            "epoch": epoch,
        },
        part,
    )
    part.replace(path)


def _restore(path: Path, net: StripFNO, optimiser: torch.optim.Optimizer, settings: Settings) -> int:
    """Return the number of epochs that the checkpoint has behind it, 0 when there is none."""
    if not path.exists():
        return 0
    try:
        state = torch.load(path, weights_only=True)
        same = state["settings"] == asdict(settings)
    except (OSError, RuntimeError, KeyError, TypeError, EOFError) as error:
        raise InputError(
            f"not a checkpoint of meshonet train ({error})", "remove it", source=str(path)
        ) from None
    if not same:
        raise InputError(
            "the checkpoint was made with other settings", "remove it or repeat them", source=str(path)
        )
    net.load_state_dict(state["net"])
    optimiser.load_state_dict(state["optimiser"])
    return int(state["epoch"])


def _write(
    path: Path,
    net: StripFNO,
    basis: Floats,
    scale: float,
    name: str,
    recipe: Mapping[str, Any],
    figures: Mapping[str, Any],
) -> None:
    """Write float16 weights; the basis keeps float32."""
    from safetensors.numpy import save

    arrays = {key: value.numpy().astype(np.float16) for key, value in net.state_dict().items()}
    arrays["basis"] = basis.astype(np.float32)
    header = {
        "kind": KIND,
        "encoding": str(VERSION),
        "name": name,
        "topology": "o",
        "scale": repr(scale),
        "recipe": json.dumps(recipe, sort_keys=True),
        "figures": json.dumps(figures, sort_keys=True),
    }
    part = path.with_name(path.name + ".part")
    part.write_bytes(save(arrays, metadata=header))
    part.replace(path)
