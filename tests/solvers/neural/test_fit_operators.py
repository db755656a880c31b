"""Operators learn, repeatably; a run that is cut off goes on as if it had not been."""

import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from families import arches, rings

from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.conformal.harmonic import extend
from meshonet.solvers.neural.fit.loop import Progress, Task, beside
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team, team
from meshonet.solvers.neural.fit.train import train
from meshonet.solvers.neural.models.architectures import ARCHITECTURES, architecture, settings_of
from meshonet.solvers.neural.models.operator import PaperOperator
from meshonet.solvers.neural.registry import load
from meshonet.solvers.neural.samples import Samples

SMALL = Plan(epochs=8, batch=2, rate=3e-3, points=(20, 10), device="cpu")
SIZES = {"sensors": 12, "hidden": [8], "features": 6}
FOURIER = {"width": 8, "modes": 3, "layers": 2, "padding": 2}
SMALLER: dict[str, dict[str, object]] = {
    "fno1d": FOURIER,
    "fno2d": FOURIER,
    "wno": {"width": 8, "levels": 2, "layers": 2, "padding": 2},
    "kno": {"width": 16, "modes": 3, "padding": 2},
    "lno": {"width": 8, "poles": 2},
}
ALONE = Team(torch.device("cpu"))


def fit(output: Path, plan: Plan = SMALL, samples: Samples | None = None, **rest: object) -> list[Progress]:
    samples = samples or arches()
    reports: list[Progress] = []
    kind = str(rest.pop("kind", "meshonet"))
    own = settings_of(architecture(kind, samples.topology))
    sizes = SMALLER.get(kind) or {name: size for name, size in SIZES.items() if name in own}
    options = {"recipe": {}, "report": reports.append, "settings": sizes, **rest}
    train(kind, samples, output, plan, ALONE, **options)  # type: ignore[arg-type]
    return reports


def read(path: Path) -> PaperOperator:
    operator = load(path)
    assert isinstance(operator, PaperOperator)
    return operator


def losses(message: list[Progress]) -> list[float]:
    return [one.loss for one in message]


@pytest.mark.parametrize("kind", [kind for kind in ARCHITECTURES if not architecture(kind, "quad").physics])
@pytest.mark.parametrize("samples", [arches(), rings()], ids=["quad", "o"])
def test_the_loss_falls(tmp_path: Path, kind: str, samples: Samples) -> None:
    epochs = 20 if kind in SMALLER else 60  # these take longer for an epoch and learn more in it
    report = fit(tmp_path / "m.safetensors", replace(SMALL, epochs=epochs), samples, kind=kind)
    assert report[-1].loss < 0.6 * report[0].loss
    assert report[-1].loss == pytest.approx(sum(report[-1].parts.values()))
    assert report[-1].seen == epochs * len(samples.where("train"))


@pytest.mark.parametrize("samples", [arches(), rings()], ids=["quad", "o"])
def test_coefficients_of_modes_are_learnt(tmp_path: Path, samples: Samples) -> None:
    path = tmp_path / "m.safetensors"
    settings = {"sensors": 12, "hidden": [8], "modes": 3}
    model = architecture("meshonet-hard", samples.topology, settings)
    plan = replace(SMALL, epochs=120)
    figures = train("meshonet-hard", samples, path, plan, ALONE, settings=settings, recipe={})
    assert figures["test"]["boundary"] <= 1e-12
    result = read(path).model
    assert (result, result.native) == (model, True)
    bare = np.array([extend(edges) for edges in samples.boundaries()])
    base = np.linalg.norm(bare - samples.nodes) / np.linalg.norm(samples.nodes)
    assert figures["test"]["median"] < 0.5 * base


def test_test_grids_are_never_seen(tmp_path: Path) -> None:
    samples = arches()
    spoilt = replace(samples, nodes=samples.nodes.copy())
    spoilt.nodes[samples.where("test")] += 5.0
    one, other = (
        fit(tmp_path / "a.safetensors", samples=samples),
        fit(tmp_path / "b.safetensors", samples=spoilt),
    )
    assert losses(one) == losses(other)


def test_the_same_seed_gives_the_same_losses_and_another_does_not(tmp_path: Path) -> None:
    plans = (SMALL, SMALL, replace(SMALL, seed=1))
    one, two, other = (losses(fit(tmp_path / "m.safetensors", plan)) for plan in plans)
    assert one == two
    assert one != other


def stop_at(epoch: int) -> object:
    def report(message: Progress) -> None:
        if message.epoch == epoch:
            raise KeyboardInterrupt

    return report


def test_a_run_that_was_cut_off_goes_on_as_if_it_had_not_been(tmp_path: Path) -> None:
    plan = replace(SMALL, checkpoint_every=3, log_every=2)
    whole = fit(tmp_path / "whole.safetensors", plan)
    cut = tmp_path / "cut.safetensors"
    with pytest.raises(KeyboardInterrupt):
        fit(cut, plan, report=stop_at(6))
    assert not cut.exists()
    resumed = fit(cut, plan, resume=True)
    assert [report.epoch for report in resumed] == [4, 6, 8], "from the checkpoint of epoch 3"
    assert losses(resumed) == losses(whole)[1:], "the sums of the report that was cut are in the checkpoint"
    first, second = (read(tmp_path / f"{name}.safetensors").weights for name in ("whole", "cut"))
    assert all(np.array_equal(first[key], second[key]) for key in first)


KILLED = """
import sys, torch
torch.set_num_threads(1)
from pathlib import Path
sys.path.insert(0, {folder!r})
from test_fit_operators import SMALL, fit
from dataclasses import replace
fit(Path(sys.argv[1]), replace(SMALL, epochs=1_000_000))
"""


def test_a_checkpoint_survives_a_kill(tmp_path: Path) -> None:
    """`kill -9` in the middle of a run that writes checkpoints all the time: the last one is whole."""
    output = tmp_path / "m.safetensors"
    code = KILLED.format(folder=str(Path(__file__).parent))
    run = subprocess.Popen([sys.executable, "-c", code, str(output)])
    try:
        until = time.monotonic() + 60
        while not beside(output).exists() and time.monotonic() < until:
            time.sleep(0.05)
        time.sleep(0.3)
    finally:
        run.send_signal(signal.SIGKILL)
        run.wait()
    state = torch.load(beside(output), weights_only=True)
    epoch = int(state["epoch"])
    assert epoch >= 1
    whole = fit(tmp_path / "w.safetensors", replace(SMALL, epochs=epoch + 3))
    plan = replace(SMALL, epochs=epoch + 3)
    state["facts"]["epochs"] = epoch + 3
    torch.save(state, beside(output))
    assert losses(fit(output, plan, resume=True)) == losses(whole)[-3:]


def test_a_checkpoint_of_another_model_or_other_data_is_refused(tmp_path: Path) -> None:
    output = tmp_path / "m.safetensors"
    with pytest.raises(KeyboardInterrupt):
        fit(output, report=stop_at(2))
    with pytest.raises(InputError, match="is of model meshonet, not meshonet-hard; remove it, or write to"):
        fit(output, kind="meshonet-hard", resume=True)
    with pytest.raises(InputError, match="made with seed 0; repeat that or remove it"):
        fit(output, replace(SMALL, seed=4), resume=True)
    with pytest.raises(InputError, match="made with data"):
        fit(output, samples=arches(n=9).pick([0, 1, 3, 2, 4, 5]), resume=True)
    fit(output, replace(SMALL, rate=1e-4), resume=True)  # the remedy of a loss that is not finite


def test_a_loss_that_is_not_finite_leaves_the_last_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "m.safetensors"
    whole = losses(fit(tmp_path / "w.safetensors"))
    step = Task.__call__

    def broken(self: Task, rows: torch.Tensor, done: int) -> torch.Tensor:
        return step(self, rows, done) * (float("nan") if done > 12 else 1.0)

    monkeypatch.setattr(Task, "__call__", broken)
    with pytest.raises(
        SolverError, match=r"not finite in epoch 5; resume from the last checkpoint with a smaller"
    ):
        fit(output)
    monkeypatch.undo()
    assert losses(fit(output, resume=True)) == whole[4:]


def test_weights_that_are_not_finite_never_reach_a_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "m.safetensors"

    def poison(self: torch.optim.Adam, closure: object = None) -> None:
        self.param_groups[0]["params"][0].data[0] = float("inf")

    monkeypatch.setattr(torch.optim.Adam, "step", poison)
    with pytest.raises(SolverError, match="is not finite after epoch 1"):
        fit(output, replace(SMALL, batch=30))
    assert not beside(output).exists()


def test_too_little_memory_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def short(self: Task, rows: torch.Tensor, done: int) -> torch.Tensor:
        raise torch.OutOfMemoryError("CUDA out of memory")

    monkeypatch.setattr(Task, "__call__", short)
    with pytest.raises(
        SolverError, match=r"not enough memory for 2 shapes a step; use a smaller batch or fewer p"
    ):
        fit(tmp_path / "m.safetensors")


def test_it_stops_when_the_held_out_loss_no_longer_falls(tmp_path: Path) -> None:
    plan = replace(SMALL, epochs=400, rate=0.5, patience=5)
    report = fit(tmp_path / "m.safetensors", plan, held_out=1)
    assert report[-1].epoch < 400
    best = min(report, key=lambda one: one.held_out["loss"])
    assert report[-1].epoch == best.epoch + 5
    assert read(tmp_path / "m.safetensors").header["figures"]["epoch"] == best.epoch
    with pytest.raises(InputError, match="patience: stopping early needs shapes held out; use held_out"):
        fit(tmp_path / "n.safetensors", plan)


def test_schedules() -> None:
    step = Plan(epochs=30, rate=1e-3, schedule="step", decay_every=10)
    rates = [step.rate_at(done, 2) for done in (1, 20, 21, 60)]
    assert rates == pytest.approx([1e-3, 1e-3, 0.9e-3, 0.81e-3])
    cosine = replace(step, schedule="cosine")
    assert cosine.rate_at(30, 2) == pytest.approx(0.5e-3, rel=0.01)
    assert cosine.rate_at(60, 2) == pytest.approx(1e-6)
    with pytest.raises(InputError, match="rate: 2 is no learning rate"):
        replace(step, rate=2.0)


def test_too_few_grids_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="1 grids to train on; give at least 2"):
        fit(tmp_path / "m.safetensors", samples=arches().pick([0]))


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is one")
def test_a_device_that_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="device: torch sees no CUDA device; use device cpu or auto"):
        team("cuda")
    assert team("auto").device.type == "cpu"


def test_half_precision_trains_too(tmp_path: Path) -> None:
    whole = losses(fit(tmp_path / "m.safetensors"))
    mixed = losses(fit(tmp_path / "m.safetensors", replace(SMALL, amp=True)))
    assert mixed != whole
    assert mixed[-1] == pytest.approx(whole[-1], rel=0.2)


def test_a_compiled_step_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiling takes a minute, so torch's compiler is stood in for by one that counts."""
    steps: list[int] = []

    def compiler(task: Task) -> object:
        def step(rows: torch.Tensor, done: int) -> torch.Tensor:
            steps.append(done)
            return task(rows, done)

        return step

    monkeypatch.setattr(torch, "compile", compiler)
    whole = losses(fit(tmp_path / "m.safetensors"))
    assert not steps
    assert losses(fit(tmp_path / "m.safetensors", replace(SMALL, compiled=True))) == whole
    assert len(steps) == 24
