"""Training of the quad operator: learns, is deterministic and resumable, knows its symmetries."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from relabelling import relabelled

from meshonet.geometry.errors import InputError
from meshonet.geometry.families.four_sided import boundary
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.fit.loop import Progress
from meshonet.solvers.neural.fit.networks import QuadUNet
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.quad import PARTS, QuadUNetSizes
from meshonet.solvers.neural.fit.quad_grids import Quads, quads
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.fit.train import train
from meshonet.solvers.neural.model_file import read_tensors
from meshonet.solvers.neural.quad.encoding import FEATURES, LATENT, features
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.quad.symmetry import ORDER
from meshonet.solvers.neural.samples import Samples, gathered

SMALL = Plan(
    epochs=3, batch=6, rate=3e-3, schedule="cosine", warm_up=2, weight_decay=1e-3, clip=1.0, device="cpu"
)
SIZES = QuadUNetSizes((1, 1), (0, 1))
ALONE = Team(torch.device("cpu"))


@pytest.fixture(scope="module")
def solved() -> tuple[Samples, Samples]:
    torch.set_num_threads(1)
    edges = [boundary(np.random.default_rng(seed), LATENT, LATENT) for seed in range(16)]
    one, other = ([method(edge).grid for edge in edges] for method in (variational, winslow))
    return gathered(one), gathered(other)


@pytest.fixture(scope="module")
def given(solved: tuple[Samples, Samples]) -> Quads:
    return quads(*solved)


def fit(given: Quads, output: Path, plan: Plan = SMALL, *, resume: bool = False) -> list[Progress]:
    reports: list[Progress] = []
    train(
        "quad",
        given,
        output,
        plan,
        ALONE,
        held_out=4,
        sizes=SIZES,
        recipe={},
        resume=resume,
        report=reports.append,
    )
    return reports


@pytest.mark.parametrize("element", range(ORDER))
def test_the_answer_to_a_relabelled_domain_is_the_relabelled_answer(element: int) -> None:
    torch.manual_seed(1)
    net = QuadUNet((1, 2, 2), (1, 1, 1)).double()
    rng, t = np.random.default_rng(0), np.linspace(-0.5, 0.5, LATENT)
    noise = 0.02 * rng.normal(size=(2, 2, LATENT, LATENT))
    z = t[:, None] + 1j * t + noise[0] + 1j * noise[1]

    def answer(z: np.ndarray) -> np.ndarray:
        return np.asarray(net(torch.from_numpy(features(*approach(z, np), np))).detach().numpy())

    plain = answer(z)
    assert np.abs(plain).max() > 1e-4
    np.testing.assert_allclose(answer(relabelled(z, element)), relabelled(plain, element), atol=1e-13)


def test_the_answer_vanishes_on_the_rim() -> None:
    net = QuadUNet((1, 2), (1, 1))
    answer = net(torch.randn(2, LATENT, LATENT, FEATURES))
    for side in (answer[..., 0, :], answer[..., -1, :], answer[..., 0], answer[..., -1]):
        assert not side.abs().any()


def test_domains_are_paired_by_their_boundary(solved: tuple[Samples, Samples], given: Quads) -> None:
    turned = replace(solved[1], nodes=solved[1].nodes[::-1])
    again = quads(solved[0], turned)
    torch.testing.assert_close(again.winslow, given.winslow, rtol=0, atol=0)
    with pytest.raises(InputError, match="no domain is in both datasets"):
        quads(solved[0], replace(solved[1], nodes=solved[1].nodes + 1.0))


def test_grids_of_another_size_are_refused(solved: tuple[Samples, Samples]) -> None:
    with pytest.raises(InputError, match="17 x 17 nodes among those to train on"):
        quads(solved[0], replace(solved[1], nodes=solved[1].nodes[:, ::2, ::2]))


def test_the_loss_falls(given: Quads, tmp_path: Path) -> None:
    reports = fit(given, tmp_path / "m.safetensors", replace(SMALL, epochs=40, rate=1e-2))
    assert reports[-1].parts["winslow"] < 0.85 * reports[0].parts["winslow"]
    assert reports[0].parts["angles"] == 0 < reports[-1].parts["angles"]
    header, tensors = read_tensors(tmp_path / "m.safetensors")
    assert header["kind"] == "meshonet quad operator"
    assert header["figures"]["domains"] == 4
    assert tensors["project"].shape == (2, 2, 1)


def test_parts_of_the_loss_are_weighed(given: Quads, tmp_path: Path) -> None:
    reports: list[Progress] = []
    for weights in ({}, {"folds": 0.0, "winslow": 2 * PARTS["winslow"]}):
        output, plan = tmp_path / "m.safetensors", replace(SMALL, epochs=1, batch=12)
        known = {"held_out": 4, "sizes": SIZES, "recipe": {}}
        train("quad", given, output, plan, ALONE, weights=weights, report=reports.append, **known)  # type: ignore[arg-type]
    assert reports[1].parts["winslow"] == pytest.approx(2 * reports[0].parts["winslow"], rel=1e-6)
    assert reports[1].parts["variational"] == reports[0].parts["variational"]
    recipe = read_tensors(tmp_path / "m.safetensors")[0]["recipe"]
    assert recipe["weights"] == {**PARTS, "folds": 0.0, "winslow": 0.4}


@pytest.mark.parametrize(
    ("weights", "message"),
    [({"fold": 1.0}, "has no part 'fold'"), ({"folds": -1.0}, "no weight"), ({"folds": "much"}, "no weight")],
)
def test_weights_of_no_part_are_refused(
    given: Quads, tmp_path: Path, weights: dict[str, float], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        train("quad", given, tmp_path / "m", SMALL, ALONE, held_out=4, weights=weights, recipe={})


def test_products_in_bfloat16_train_too(given: Quads, tmp_path: Path) -> None:
    """`--amp`: there are no complex numbers of that precision."""
    last = fit(given, tmp_path / "quad.safetensors", replace(SMALL, amp=True))[-1]
    plain = fit(given, tmp_path / "plain.safetensors")[-1]
    assert last.loss == pytest.approx(plain.loss, rel=0.05)


def test_the_same_seed_gives_the_same_weights_cut_or_not(given: Quads, tmp_path: Path) -> None:
    whole, cut, other = (tmp_path / f"{name}.safetensors" for name in ("whole", "cut", "other"))
    expected = fit(given, whole)

    def stop(report: Progress) -> None:
        if report.epoch == 2:
            raise KeyboardInterrupt

    settings = {"held_out": 4, "sizes": SIZES, "recipe": {}}
    with pytest.raises(KeyboardInterrupt):
        train("quad", given, cut, SMALL, ALONE, report=stop, **settings)  # type: ignore[arg-type]
    assert not cut.exists()
    resumed = fit(given, cut, resume=True)
    assert [r.loss for r in resumed] == [r.loss for r in expected[-len(resumed) :]]
    fit(given, other, replace(SMALL, seed=1))
    first, second, third = (read_tensors(path)[1] for path in (whole, cut, other))
    assert all(np.array_equal(first[key], second[key]) for key in first)
    assert not all(np.array_equal(first[key], third[key]) for key in first)


@pytest.mark.parametrize("held_out", [0, 12])
def test_too_few_domains_are_refused(given: Quads, tmp_path: Path, held_out: int) -> None:
    with pytest.raises(InputError, match="16 domains to train on"):
        train("quad", given, tmp_path / "m.safetensors", SMALL, ALONE, held_out=held_out, recipe={})


def test_figures_count_folds_and_gains(given: Quads) -> None:
    from meshonet.solvers.neural.fit.quad_figures import held_out_figures

    base, goal, best = (z.numpy() for z in (given.base, given.winslow, given.variational))
    figures = held_out_figures(np.stack([goal, best], axis=1), base, goal, best)
    for head in ("winslow", "variational"):
        assert figures[head]["relative_l2"] == {"median": 0.0, "p90": 0.0}
    assert figures["variational"]["fold_free"] == 1.0
    assert figures["variational"]["mean_gain"] == pytest.approx(1.0)
    folded = best.copy()
    folded[0, 5, 5] = folded[0, 20, 20]
    figures = held_out_figures(np.stack([goal, folded], axis=1), base, goal, best)
    assert figures["variational"]["fold_free"] == pytest.approx(15 / 16, rel=1e-2)
