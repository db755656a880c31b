"""Options that a shape or a method has no use for are refused, not passed over."""

from pathlib import Path

import numpy as np
import pytest
from command_line import BOUNDARY_COMMANDS, Meshonet, dataset, duct

USELESS = {
    "a four-sided outline": ("duct.csv", "--res 31x15", ["--far-field 9"]),
    "a body": (
        "disc.csv", "--res 41x15",
        ["--topology o --corners 0,10,20,30", "--te round", "--base .01", "--wake 5"],
    ),
    "a domain": ("square.csv", "", ["--te round", "--base .01", "--smooth 1e-4"]),
    "given edges": (
        "edges.h5",
        "",
        [
            "--topology o", "--spacing tanh", "--le-spacing .01", "--te-spacing .01", "--far-field 9",
            "--corners 0,1,2,3", "--te round", "--wake 5", "--wake-nodes 9", "--base .01", "--base-nodes 9",
            "--smooth 1e-4", "--normalise",
        ],
    ),
    "an O grid": ("naca:2412", "--res 41x15 --topology o", ["--wake 5", "--wake-nodes 9"]),
}  # fmt: skip


@pytest.mark.parametrize(("kind", "words"), [(kind, w) for kind, (*_, ws) in USELESS.items() for w in ws])
@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_an_option_that_the_shape_has_no_use_for_is_refused(
    meshonet: Meshonet, command: str, kind: str, words: str
) -> None:
    edges = duct(31, 15)
    dataset(Path("edges.h5"), "quad", edges)
    ring = [edges["south"], edges["east"][1:], edges["north"][-2::-1], edges["west"][-2:0:-1]]
    Path("duct.csv").write_text("\n".join(f"{x},{y}" for side in ring for x, y in side))
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    Path("disc.csv").write_text("\n".join(f"{x},{y}" for x, y in zip(np.cos(t), np.sin(t), strict=True)))
    Path("square.csv").write_text("0 0\n9 0\n9 9\n0 9\n\n4 4\n4 5\n5 5\n5 4\n")
    source, base, _ = USELESS[kind]
    done = meshonet(command, source, *base.split(), *words.split(), "-o", "none.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "; leave --" in done.err
    assert not Path("none.h5").exists()


def test_a_fallback_without_a_network_is_refused(meshonet: Meshonet) -> None:
    done = meshonet("infer", "naca:2412", "--model", "base", "--fallback", "-o", "none.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "--fallback is of no use to --model base: no network makes the grid; drop --fallback" in done.err
    assert not Path("none.h5").exists()


@pytest.mark.parametrize("answer", ["raw", "pasted"])
def test_an_answer_without_a_network_is_refused(meshonet: Meshonet, answer: str) -> None:
    done = meshonet("infer", "naca:2412", "--answer", answer, "-o", "none.h5")
    assert done.code == 2
    assert done.err == "error: --answer without a network; give --model as well, or drop --answer\n"
    assert not Path("none.h5").exists()


MARCHED = ("naca:2412", "--res", "81x31", "--wall-spacing", "1e-4", "-o", "none.h5")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("solve-pde", ("--max-cycles", "3")),
        ("solve-pde", ("--slide",)),
        ("solve-pde", ("--tol", "1e-9")),
        ("infer", ("--answer", "raw")),
        ("infer", ("--polish", "3")),
    ],
)
def test_an_option_that_a_march_has_no_use_for_is_refused(
    meshonet: Meshonet, command: str, words: tuple[str, ...]
) -> None:
    done = meshonet(command, *MARCHED, *words)
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert f"{words[0]} is of no use to a grid marched from the wall; drop {words[0]}" in done.err
    assert not Path("none.h5").exists()
    assert not Path("cycles.csv").exists()
