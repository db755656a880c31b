"""Physics-informed networks: derivatives, residual, what they learn, and whom they answer."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from families import arches, rings

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.loop import Progress
from meshonet.solvers.neural.fit.physics_task import PhysicsTask
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.fit.train import train
from meshonet.solvers.neural.models.architectures import architecture
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.models.operator import PaperOperator
from meshonet.solvers.neural.registry import load
from meshonet.solvers.neural.samples import Samples

PLAN = Plan(epochs=200, points=(60, 40), rate=5e-3, schedule="cosine", device="cpu", log_every=50)
ALONE = Team(torch.device("cpu"))
SMALL = {"width": 12, "depth": 2}


def task(samples: Samples, **settings: object) -> PhysicsTask:
    model = architecture("mgnet", samples.topology, {**SMALL, **settings})
    assert isinstance(model, MGNet)
    return PhysicsTask(model, samples, (30, 10), 0, torch.device("cpu")).double()


def residual(one: PhysicsTask, points: torch.Tensor) -> torch.Tensor:
    return one._residual(dict(one.named_parameters()), points)


@pytest.mark.parametrize("samples", [arches(2), rings(2)], ids=["quad", "o"])
def test_exact_derivatives_are_those_of_autograd(samples: Samples) -> None:
    one = task(samples)
    net: dict[str, Any] = dict(one.named_parameters())
    point = torch.tensor([0.3, 0.6], dtype=torch.float64)

    def place(p: torch.Tensor) -> torch.Tensor:
        return one._plain(net, p[None])[1, 0]

    first = torch.autograd.functional.jacobian(place, point)
    second = [torch.autograd.functional.hessian(lambda p, d=d: place(p)[d], point) for d in (0, 1)]
    (xx, xe), (_, ee) = torch.stack(second, -1)
    Xx, Xe = first[:, 0], first[:, 1]
    wanted = (Xe @ Xe) * xx - 2 * (Xx @ Xe) * xe + (Xx @ Xx) * ee
    assert wanted.abs().max() > 1e-3
    torch.testing.assert_close(residual(one, point[None])[1, 0], wanted)


def test_differences_converge_to_exact_derivatives_at_second_order() -> None:
    points = torch.tensor([[0.3, 0.6], [0.7, 0.2]], dtype=torch.float64)
    exact = residual(task(arches(2)), points)
    errors = [
        float((residual(task(arches(2), finite=h), points) - exact).abs().max().detach())
        for h in (0.04, 0.02, 0.01)
    ]
    slope = np.polyfit(np.log([0.04, 0.02, 0.01]), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)


def fit(
    samples: Samples, output: Path, kind: str = "mgnet", plan: Plan = PLAN, **settings: object
) -> list[Progress]:
    reports: list[Progress] = []
    settings = {**SMALL, **settings}
    train(kind, samples, output, plan, ALONE, settings=settings, recipe={}, report=reports.append)
    return reports


@pytest.mark.parametrize(
    ("kind", "settings"),
    [("mgnet", {}), ("mgnet", {"finite": 0.02}), ("mgnet", {"lines": 2}), ("meshnet", {"coarse": 3})],
)
def test_the_loss_falls(tmp_path: Path, kind: str, settings: dict[str, object]) -> None:
    report = fit(arches(1), tmp_path / "m.safetensors", kind, **settings)
    assert report[-1].loss < 0.3 * report[0].loss
    assert (report[-1].parts["data"] > 0) == bool(settings.get("lines") or settings.get("coarse"))


def test_it_answers_the_geometries_it_knows_and_no_other(tmp_path: Path) -> None:
    output = tmp_path / "m.safetensors"
    fit(rings(2), output, plan=replace(PLAN, epochs=30))
    trained = load(output)
    assert isinstance(trained, PaperOperator)
    for edges, nodes in zip(rings(2).boundaries(), rings(2).nodes, strict=True):
        result, _ = trained.nodes(edges)
        assert result.shape == nodes.shape
    with pytest.raises(
        InputError, match=r"knows 2 geometries, and this one is off the nearest by .*train it on"
    ):
        trained.nodes(rings(3).boundaries()[1])


def test_a_coarse_grid_finer_than_the_grid_is_refused() -> None:
    with pytest.raises(InputError, match="set: coarse=40; use 3 to 9"):
        task(arches(2), coarse=40)
