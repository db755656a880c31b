"""Training is deterministic, resumable, and learns."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.families import procedural
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.conformal.strip import across, harmonic, picard
from meshonet.solvers.neural.fit.loop import Progress
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.strip import StripSizes, distance
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.fit.train import train
from meshonet.solvers.neural.model_file import read_tensors
from meshonet.solvers.neural.registry import load
from meshonet.solvers.neural.strip.dataset import Strips, solve_strips
from meshonet.solvers.neural.strip.operator import StripOperator

SMALL = Plan(
    epochs=3, batch=8, rate=2e-3, schedule="cosine", warm_up=4, weight_decay=1e-4, clip=1.0, device="cpu"
)
REST = {"held_out": 4, "sizes": StripSizes(basis=6, width=8, modes=10, layers=1), "recipe": {}}
ALONE = Team(torch.device("cpu"))


@pytest.fixture(scope="module")
def strips() -> Strips:
    rng = np.random.default_rng(5)
    torch.set_num_threads(1)
    return solve_strips(procedural.boundary(rng, 97, 3) for _ in range(24))


def fit(strips: Strips, output: Path, plan: Plan = SMALL, **rest: object) -> list[Progress]:
    reports: list[Progress] = []
    train("strip", strips, output, plan, ALONE, report=reports.append, **{**REST, **rest})  # type: ignore[arg-type]
    return reports


def test_strips_solve_winslows_equations(strips: Strips) -> None:
    for m in range(3):
        result = harmonic(strips.wall[m], strips.far[m], across().eta) + strips.residual[m]
        assert picard(result, 1)[1][0] < 1e-4, "a solution is where another step changes nothing"
        assert np.abs(strips.residual[m]).max() > 1e-5
        np.testing.assert_array_equal(strips.residual[m][:, [0, -1]], 0)


def test_the_loss_falls_and_the_file_loads(strips: Strips, tmp_path: Path) -> None:
    reports = fit(strips, tmp_path / "m.safetensors", replace(SMALL, epochs=12))
    assert reports[-1].loss < 0.5 * reports[0].loss
    assert load(tmp_path / "m.safetensors").name == "m"
    assert not (tmp_path / "m.safetensors.checkpoint").exists()


def test_the_file_answers_as_the_network_did(strips: Strips, tmp_path: Path) -> None:
    output = tmp_path / "m.safetensors"
    figures = train("strip", strips, output, replace(SMALL, epochs=12), ALONE, **REST)  # type: ignore[arg-type]
    model, test = load(output), strips[-4:]
    assert isinstance(model, StripOperator)
    answers = model.residual(test.wall, test.far)
    results = [distance(answer, goal) for answer, goal in zip(answers, test.residual, strict=True)]
    assert np.median(results) == pytest.approx(figures["network"]["median"], rel=0.02)


def test_the_same_seed_gives_the_same_weights_and_another_does_not(strips: Strips, tmp_path: Path) -> None:
    one, two, other = (tmp_path / f"{k}.safetensors" for k in "abc")
    fit(strips, one)
    fit(strips, two)
    fit(strips, other, replace(SMALL, seed=1))
    models = [read_tensors(path)[1] for path in (one, two, other)]
    assert all(np.array_equal(models[0][key], models[1][key]) for key in models[0])
    assert not all(np.array_equal(models[0][key], models[2][key]) for key in models[0])


def test_a_run_that_was_cut_off_goes_on_as_if_it_had_not_been(strips: Strips, tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.safetensors", tmp_path / "cut.safetensors"
    expected = fit(strips, whole)

    def stop(report: Progress) -> None:
        if report.epoch == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train("strip", strips, cut, SMALL, ALONE, report=stop, **REST)  # type: ignore[arg-type]
    assert not cut.exists()
    resumed = fit(strips, cut, resume=True)
    assert [report.epoch for report in resumed] == [3]
    assert resumed[0].loss == expected[2].loss
    wanted, result = read_tensors(whole)[1], read_tensors(cut)[1]
    for key in wanted:
        np.testing.assert_array_equal(result[key], wanted[key])


def test_a_checkpoint_of_other_settings_is_refused(strips: Strips, tmp_path: Path) -> None:
    output = tmp_path / "m.safetensors"

    def stop(report: Progress) -> None:
        if report.epoch == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train("strip", strips, output, SMALL, ALONE, report=stop, **REST)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="made with seed 0; repeat that or remove it"):
        fit(strips, output, replace(SMALL, seed=3), resume=True)
    (tmp_path / "m.safetensors.checkpoint").write_bytes(b"no checkpoint")
    with pytest.raises(InputError, match="not a checkpoint"):
        fit(strips, output, resume=True)


def test_too_few_shapes_are_refused(strips: Strips, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="10 shapes to train on; give at least 12"):
        fit(strips[:10], tmp_path / "m.safetensors")


def test_a_loss_that_is_not_finite_stops_the_run(strips: Strips, tmp_path: Path) -> None:
    broken = Strips(strips.wall, strips.far, strips.residual * np.nan)
    with pytest.raises((SolverError, np.linalg.LinAlgError)):
        fit(broken, tmp_path / "m.safetensors")


def test_boundaries_that_cannot_be_lifted_are_left_out_and_others_refused() -> None:
    good: Boundary = naca("2412").boundary(Sampling(ni=97, nj=3))
    tiny = naca("0012").boundary(Sampling(ni=8, nj=3))
    counts: list[tuple[int, int]] = []
    result = solve_strips([good, tiny], lambda done, left_out: counts.append((done, left_out)))
    assert len(result) == 1
    assert counts[-1] == (1, 1)
    with pytest.raises(InputError, match="no boundary could be lifted"):
        solve_strips([tiny])
