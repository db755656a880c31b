"""Grids on a device: those of here, and nothing left here on the way (`pretend_device`)."""

from typing import Any, cast

import numpy as np
import pytest
from random_quads import random_quad

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.bodies import boundary
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.neural.inference import infer_many

torch = pytest.importorskip("torch")
from pretend_device import DEVICE, Pretended  # noqa: E402 - it imports torch

torch.set_num_threads(1)  # tests run side by side


def domains() -> list[Boundary]:
    results = [random_quad(seed, 21, 25) for seed in (3, 5)]
    return [one for one in results if one is not None]


def bodies() -> list[Boundary]:
    return [boundary(np.random.default_rng([1, k]), 41, 17) for k in range(2)]


def sections() -> list[Boundary]:
    return [naca(name).boundary(Sampling(81, 20, "o")) for name in ("2412", "0012-sharp")]


@pytest.mark.parametrize(
    ("model", "given"),
    [
        ("airfoil-o", sections),
        ("base", sections),
        ("quad-general", domains),
        ("quad-winslow", domains),
        ("hole-o", bodies),
        ("hole-winslow", bodies),
    ],
)
def test_a_device_makes_the_grids_of_here(model: str, given: Any) -> None:
    here = infer_many(given(), model, device="cpu")
    with Pretended():
        there = infer_many(given(), model, device=cast("Any", DEVICE))
    for one, other in zip(here, there, strict=True):
        assert other.grid.provenance["device"] == DEVICE
        np.testing.assert_array_equal(one.grid.nodes, other.grid.nodes)


def test_what_is_left_here_is_found() -> None:
    """The pretended device itself: as a true one it takes no other's tensors but single numbers."""
    with Pretended():
        there = torch.arange(3.0, device=DEVICE)
        assert float((2.0 * there + torch.tensor(1.0)).sum()) == 9.0
        for wrong in (lambda: there + torch.ones(3), lambda: there @ torch.ones(3)):
            with pytest.raises(RuntimeError, match="are not there"):
                wrong()


def test_a_device_without_enough_memory_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise torch.OutOfMemoryError("CUDA out of memory.\nMore of it.")

    monkeypatch.setattr("meshonet.solvers.neural.devices._grids", lambda *_: full)
    with pytest.raises(MemoryError, match=r"^CUDA out of memory\.$"):
        infer_many(domains(), "quad-general", device="cpu")


def test_a_missing_device_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    for model, given in (("hole-o", bodies), ("quad-general", domains), ("airfoil-o", sections)):
        with pytest.raises(InputError, match="torch sees no CUDA device; use device cpu, or leave it out"):
            infer_many(given(), model, device="cuda")
