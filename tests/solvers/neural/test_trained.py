"""A trained operator answers alike in numpy and torch, keeps its promises, and its file is untrusted."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import torch
from families import arches, rings
from inferred import infer
from safetensors.numpy import load_file, save_file

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.operators import differences
from meshonet.solvers.neural.model_file import HEADER, PAPER, write_model
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.architectures import ARCHITECTURES, architecture
from meshonet.solvers.neural.models.layers import initial
from meshonet.solvers.neural.models.operator import PaperOperator
from meshonet.solvers.neural.models.sensors import lift, rim, sensors, square
from meshonet.solvers.neural.registry import load
from meshonet.solvers.neural.samples import Samples

FAMILIES = {"quad": arches(), "o": rings()}


def random(kind: str, samples: Samples, **settings: object) -> PaperOperator:
    """A model with random weights."""
    model = architecture(kind, samples.topology, settings)
    frame = Frame(samples.topology, samples.ni, samples.nj, len(samples))
    fixed = model.fixed(samples, differences(model, samples))
    arrays = initial(model.shapes(frame), np.random.default_rng(3)) | fixed
    single = {k: v.astype(np.float32) for k, v in arrays.items()}
    return PaperOperator("random", samples.topology, {}, model, frame, single)


def write(path: Path, trained: PaperOperator, arrays: Mapping[str, np.ndarray]) -> None:
    write_model(path, PAPER, arrays, name="m", recipe={}, figures={}, **trained.facts())


KINDS: list[tuple[str, dict[str, int]]] = [
    *((kind, {}) for kind in ARCHITECTURES),
    ("meshonet-hard", {"modes": 4, "within": True}),
]


@pytest.mark.parametrize("topology", FAMILIES)
@pytest.mark.parametrize(("kind", "settings"), KINDS)
def test_numpy_and_torch_agree(kind: str, settings: dict[str, int], topology: str) -> None:
    samples = FAMILIES[topology]
    trained = random(kind, samples, **settings)
    inputs = trained.model.encode(samples.boundaries())
    where, index = square(samples.ni, samples.nj), np.arange(samples.ni * samples.nj)
    answer, seen = trained.model.answer, trained.model.seen
    single = {k: v.astype(np.float32) for k, v in inputs.items()}
    result = answer(np, trained.weights, single, seen(np, where.astype("f4")), index)
    tensors = (
        {k: torch.tensor(v, dtype=torch.float32) for k, v in a.items()} for a in (trained.weights, inputs)
    )
    places = seen(torch, torch.tensor(where, dtype=torch.float32))
    goal = answer(torch, *tensors, places, torch.tensor(index))
    assert result.shape == (len(samples), samples.ni * samples.nj, 2)
    np.testing.assert_allclose(result, goal.numpy(), atol=2e-5 * float(goal.abs().max()))


def test_the_paper_counts_as_many_parameters() -> None:
    model = architecture("meshonet", "quad")
    assert sum(np.prod(shape) for shape in model.shapes(Frame("quad", 101, 101)).values()) == 54_482


def test_the_page_counts_every_models_parameters() -> None:
    page = (Path(__file__).parents[3] / "docs" / "theory" / "paper-models.md").read_text()
    for kind in ARCHITECTURES:
        shapes = architecture(kind, "quad").shapes(Frame("quad", 101, 101, 1))
        assert f"| `{kind}` | {sum(int(np.prod(shape)) for shape in shapes.values()):,}" in page


@pytest.mark.parametrize("topology", FAMILIES)
@pytest.mark.parametrize("size", [None, 40, 150])
@pytest.mark.parametrize("modes", [0, 4])
def test_a_hard_boundary_is_exact_whatever_the_weights(topology: str, size: int | None, modes: int) -> None:
    from meshonet.geometry.spacing.sampling import Sampling

    samples = FAMILIES[topology]
    trained = random("meshonet-hard", samples, modes=modes)
    for edges in samples.boundaries()[:2]:
        boundary = edges.boundary(Sampling(size, size)) if size else edges
        nodes, away = trained.nodes(boundary, paste=False)
        assert away <= 1e-12
        assert np.abs(nodes[3, 1:-1] - samples.nodes[0, 3, :1]).max() > 0
        if topology == "o":
            np.testing.assert_array_equal(nodes[0], nodes[-1])


@pytest.mark.parametrize("topology", FAMILIES)
def test_modes_hold_the_differences_they_are_made_of(topology: str) -> None:
    """Six grids have twelve modes of x and y; those that are asked for beyond are zero."""
    samples = FAMILIES[topology]
    model = architecture("meshonet-hard", topology, {"modes": 14})  # type: ignore[arg-type]
    wanted = differences(model, samples)
    modes = model.fixed(samples, wanted)["fixed/modes"]
    assert modes.shape == (samples.ni * samples.nj, 14)
    assert np.abs(modes[:, 12:]).max() == 0
    assert (modes[:, 0] ** 2).mean() == pytest.approx(1.0)
    rows = np.moveaxis(wanted, -1, 0).reshape(12, -1).T
    kept, _ = np.linalg.qr(modes[:, :12])
    np.testing.assert_allclose(kept @ (kept.T @ rows), rows, atol=1e-9 * np.abs(rows).max())
    missed = [rows - q @ (q.T @ rows) for q in (np.linalg.qr(modes[:, :k])[0] for k in (1, 3))]
    assert (missed[1] ** 2).sum() < 0.2 * (missed[0] ** 2).sum()


@pytest.mark.parametrize("spoil", ["nodes", "modes", "none"])
def test_modes_that_do_not_fit_are_found_when_the_file_is_read(tmp_path: Path, spoil: str) -> None:
    path = tmp_path / "m.safetensors"
    trained = random("meshonet-hard", FAMILIES["quad"], modes=4)
    arrays = dict(trained.weights)
    modes = arrays.pop("fixed/modes")
    if spoil != "none":
        arrays["fixed/modes"] = modes[:9] if spoil == "nodes" else modes[:, :3]
    write(path, trained, arrays)
    with pytest.raises(InputError, match="its header or arrays do not fit"):
        load(path)


@pytest.mark.parametrize("kind", ["fno1d", "fno2d", "wno", "kno", "lno", "pod-deeponet"])
@pytest.mark.parametrize("topology", FAMILIES)
def test_native_models_answer_finer_boundaries_on_the_nodes_they_know(kind: str, topology: str) -> None:
    fine = FAMILIES[topology]
    nodes = fine.nodes[:, ::2, ::2]
    coarse = Samples(nodes, fine.topology, fine.names, fine.splits, fine.parameters)
    settings = {"modes": 2, "padding": 2} if kind.startswith("fno") else {}
    settings |= {"levels": 2} if kind == "wno" else {}
    trained = random(kind, coarse, **settings)
    for one, other in zip(coarse.boundaries(), fine.boundaries(), strict=True):
        result, finer = trained.difference(one), trained.difference(other)
        np.testing.assert_allclose(finer[::2, ::2], result, atol=2e-5 * np.abs(result).max())


def test_beyond_the_training_shapes_the_difference_is_that_of_the_last_one() -> None:
    samples = FAMILIES["quad"]
    order = np.argsort(samples.parameters)
    known = samples.pick(order[:-1])  # all but the highest arch
    held, free = (random("meshonet-hard", known, within=within) for within in (True, False))
    last, beyond = known.boundaries()[-1], samples.boundaries()[order[-1]]
    np.testing.assert_allclose(held.difference(beyond), held.difference(last), atol=1e-6)
    assert np.abs(free.difference(beyond) - free.difference(last)).max() > 1e-3
    assert held.difference(last) == pytest.approx(free.difference(last), abs=1e-6)


def test_a_batch_answers_like_its_members() -> None:
    samples = FAMILIES["quad"]
    trained = random("meshonet", samples)
    inputs, where = trained.model.encode(samples.boundaries()), trained.model.seen(np, square(5, 7))
    together = trained.model.answer(np, trained.weights, inputs, where, None)
    for k in range(len(samples)):
        alone = trained.model.answer(
            np, trained.weights, {"sensors": inputs["sensors"][k : k + 1]}, where, None
        )
        np.testing.assert_allclose(together[k], alone[0], atol=1e-6)


def test_large_grids_agree_with_small_ones() -> None:
    """281 nodes are every second of 561: the interpolated table against the network's own values."""
    from meshonet.geometry.spacing.sampling import Sampling

    samples = FAMILIES["quad"]
    trained = random("meshonet", samples)
    small, large = (samples.boundaries()[1].boundary(Sampling(n, n)) for n in (71, 281))
    direct, table = trained.difference(small), trained.difference(large)
    assert np.abs(table[::4, ::4] - direct).max() < 3e-5


def test_sensors_are_nodes_of_the_outline_of_a_grid_that_has_them() -> None:
    samples = arches(3, n=26)
    boundary = samples.boundaries()[2]
    np.testing.assert_allclose(sensors(boundary, 50), boundary.with_sensors(50).sensors, atol=1e-14)
    ring = rings(3, n=17).boundaries()[0]
    np.testing.assert_allclose(sensors(ring, 16), ring.with_sensors(16).sensors, atol=1e-14)


def test_the_lift_is_the_papers() -> None:
    lifted = lift(np, np.array([[0.3, 0.7]]), 3)[0]
    wanted = [np.sin(0.3), np.sin(0.7), np.cos(0.3), np.cos(0.7), 0.3, 0.7, 0.09, 0.49, 0.027, 0.343]
    np.testing.assert_allclose(lifted, wanted)


def test_the_rim_of_an_o_grid_has_two_sides() -> None:
    assert rim(5, 4, "quad").sum() == 14
    assert rim(5, 4, "o").sum() == 10


def test_answers_are_pasted_or_not(tmp_path: Path) -> None:
    samples, path = FAMILIES["quad"], tmp_path / "m.safetensors"
    trained = random("meshonet", samples)
    write(path, trained, trained.weights)
    boundary = samples.boundaries()[0]
    raw, pasted = (infer(boundary, str(path), answer=how) for how in ("raw", "pasted"))  # type: ignore[arg-type]
    assert raw.grid.provenance["boundary_error"] > 1e-3
    assert np.abs(raw.grid.nodes[:, 0] - boundary.south).max() > 1e-3
    np.testing.assert_array_equal(pasted.grid.nodes[:, 0], boundary.south)
    np.testing.assert_array_equal(pasted.grid.nodes[1:-1, 1:-1], raw.grid.nodes[1:-1, 1:-1])
    assert "replaced by the true one" in pasted.notes[0]
    assert "left so" in raw.notes[0]


def test_another_topology_is_refused() -> None:
    with pytest.raises(
        InputError, match="model random makes quad grids, and this boundary is o; use another"
    ):
        random("meshonet", FAMILIES["quad"]).difference(rings().boundaries()[0])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "meshonet strip"}, "it holds 'meshonet strip'"),
        ({"version": 9}, "version 9"),
        ({"model": "perceptron"}, "model 'perceptron' is not known"),
        ({"topology": "x"}, "do not fit"),
        ({"ni": 10**9}, "do not fit"),
        ({"settings": {"sensors": 60}}, "do not fit"),
        ({"settings": {"sensors": "many"}}, "sensors='many' does not suit meshonet"),
        ({"settings": {"depth": 10**6}}, "does not suit"),
        ({"settings": {"colour": 1}}, "meshonet has no setting 'colour'; use one of"),
        ({"settings": 5}, "do not fit"),
    ],
)
def test_foreign_headers_are_refused(tmp_path: Path, change: dict[str, object], message: str) -> None:
    path, trained = tmp_path / "m.safetensors", random("meshonet", FAMILIES["quad"])
    write(path, trained, trained.weights)
    from safetensors import safe_open

    with safe_open(path, framework="numpy") as file:
        header = json.loads(file.metadata()[HEADER])
    save_file(load_file(path), path, metadata={HEADER: json.dumps(header | change)})
    with pytest.raises(InputError, match=message) as caught:
        load(path)
    assert str(path) in str(caught.value)
