"""3DMeshNet: its equations, how gradients are combined, what it learns, and which volumes it answers."""

import sys
from pathlib import Path

import numpy as np
import pytest
import torch

sys.path.insert(0, str(Path(__file__).parents[2]))
from spatial_shapes import box

import meshonet
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.fit.volume import VolumeTask, project, residual
from meshonet.solvers.neural.models.layers import dense
from meshonet.solvers.neural.volumes.network import VolumeMeshNet, infer_volume, load_volume

CPU = torch.device("cpu")


def task(**settings: object) -> VolumeTask:
    volumes = [SixFaces.of_block(box(bump=bump)) for bump in (0.1, 0.3)]
    made = VolumeMeshNet(width=8, depth=2, **settings)  # type: ignore[arg-type]
    return VolumeTask(made, volumes, (30, 40), 0, CPU)


def test_the_residual_is_winslows_of_the_networks_map() -> None:
    """Against the exact derivatives of autograd, with the adjugate as the determinant times the inverse."""
    one = task().double()
    net = {key: value[:1] for key, value in one.named_parameters() if key != "spread"}
    points = torch.rand(5, 3, dtype=torch.float64) - 0.5

    def place(p: torch.Tensor) -> torch.Tensor:
        return dense(torch, net, "net", p[None, None])[0, 0]

    for point, result in zip(points, residual(net, points, 1e-3), strict=True):
        first = torch.autograd.functional.jacobian(place, point)
        second = torch.stack(
            [torch.autograd.functional.hessian(lambda p, c=c: place(p)[c], point) for c in range(3)]
        )
        metric = first.T @ first
        exact = torch.einsum("ij,cij->c", torch.linalg.inv(metric) * torch.det(metric), second)
        torch.testing.assert_close(result, exact, rtol=1e-4, atol=1e-7)


def test_conflicting_gradients_are_projected_and_others_added() -> None:
    a, b = torch.tensor([1.0, 0.0]), torch.tensor([-1.0, 1.0])
    torch.testing.assert_close(project(a, -b), a - b)
    summed = project(a, b)
    torch.testing.assert_close(summed, torch.tensor([0.5, 0.5]) + torch.tensor([0.0, 1.0]))
    assert summed @ a >= 0
    assert summed @ b >= 0


@pytest.mark.parametrize("projected", [False, True])
def test_gradients_are_those_of_the_two_parts(projected: bool) -> None:
    one, rows = task(projected=projected), torch.arange(2)
    one.differentiate(one.forward(rows, 1), Team(CPU))
    weights = [value for name, value in one.named_parameters() if name != "spread"]
    parts = one.forward(rows, 1)
    flat = [
        torch.cat([g.reshape(-1) for g in torch.autograd.grad(part, weights, retain_graph=True)])
        for part in parts[:2]
    ]
    exact = project(*flat) if projected else flat[0] + flat[1]
    result = torch.cat([value.grad.reshape(-1) for value in weights])  # type: ignore[union-attr]
    torch.testing.assert_close(result, exact, rtol=1e-3, atol=1e-6)
    assert one.spread.grad is not None


def test_a_volume_is_learnt_and_answered_at_any_resolution(tmp_path: Path) -> None:
    faces = SixFaces.of_block(box())
    source, path = tmp_path / "box.vts", tmp_path / "box.safetensors"
    faces.grid(box()).write(source)
    report = meshonet.train(
        source, path, model="meshnet", epochs=150, points=120, rate=0.01, schedule="cosine",
        settings={"width": 16, "depth": 2},
    )  # fmt: skip
    assert report["figures"]["train"]["median"] < 0.15
    network = load_volume(str(path))
    raw, pasted = (infer_volume(faces, model=str(path), answer=answer) for answer in ("raw", "pasted"))
    assert np.array_equal(raw.grid.blocks[0].nodes, network.nodes(faces))
    for side in FACES:
        assert np.array_equal(face_of(pasted.grid.blocks[0].nodes, side), getattr(faces, side))
    fine = infer_volume(faces.resampled((17, 15, 13)), model=str(path), answer="raw").grid.blocks[0].nodes
    np.testing.assert_allclose(fine[::2, ::2, ::2], raw.grid.blocks[0].nodes, atol=1e-5)
    by_command = meshonet.infer(meshonet.read(source), model=str(path), answer="pasted", allow_invalid=True)
    assert np.array_equal(by_command.blocks[0].nodes, pasted.grid.blocks[0].nodes)
    with pytest.raises(InputError, match="the model knows 1 volumes, and this one is off the nearest"):
        infer_volume(SixFaces.of_block(box(bump=0.5)), model=str(path))
    with pytest.raises(InputError, match="this model makes volumes only; give six faces"):
        meshonet.infer("naca:2412", model=str(path))
    with pytest.raises(InputError, match="this model makes no volumes"):
        infer_volume(faces, model="quad-general")


def test_numpy_and_torch_agree() -> None:
    one = task()
    faces = one.volumes[1]
    net = {key: value[1:2] for key, value in one.named_parameters() if key != "spread"}
    axes = [np.linspace(-1, 1, n) for n in faces.counts]
    points = torch.tensor(
        np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(1, -1, 3), dtype=torch.float32
    )
    scaled = dense(torch, net, "net", points)[0].detach().numpy()
    goal = scaled * one.fixed["fixed/size"][1] + one.fixed["fixed/centre"][1]
    np.testing.assert_allclose(one.network().nodes(faces).reshape(-1, 3), goal, atol=1e-5)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"settings": {"finite": 0.9}}, "finite=0.9; use a step between 0 and 0.5"),
        ({"held_out": 1}, "a network for one volume holds none out"),
        ({"split": "random"}, "is of no use to volumes"),
        ({"points": "all"}, "all of a volume; give a number"),
        ({"settings": {"colour": 1}}, "meshnet has no setting 'colour'"),
    ],
)
def test_what_volumes_cannot_do_is_refused(tmp_path: Path, changes: dict, message: str) -> None:
    source = tmp_path / "box.vts"
    SixFaces.of_block(box()).grid(box()).write(source)
    with pytest.raises(InputError, match=message):
        meshonet.train(source, tmp_path / "m.safetensors", model="meshnet", epochs=1, **changes)
