"""Options that a shape or a method has no use for are refused, not passed over."""

from dataclasses import fields
from pathlib import Path

import pytest
from command_line import BOUNDARY_COMMANDS, Meshonet, dataset, duct
from effects import SHAPES
from test_every_option import nodes

from meshonet.geometry.spacing.sampling import Sampling

NO_OPTIONS = {"--ni", "--nj", "--nk", "--viscous", "--refined"}
OPTIONS = {"--" + each.name.replace("_", "-") for each in fields(Sampling)} - NO_OPTIONS
ONE_BLOCK = (
    "box.csv --res 31x15",
    "body.csv --res 41x15 --topology o",
    "hole.csv --res 41x15 --topology o",
    "edges.h5",
    "naca:2412 --res 61x15 --topology o",
    "naca:2412 --res 61x41 --topology c --te wedge",
)
RUNS = [f"{command} {words}" for command in BOUNDARY_COMMANDS for words in ONE_BLOCK]
RUNS += ["infer hole.csv --cells 900", "infer naca:2412 --cells 900", "sample-boundary --family arch --res 9"]


@pytest.mark.parametrize("run", RUNS)
def test_every_kind_of_shape_applies_or_refuses_an_option(meshonet: Meshonet, run: str) -> None:
    """Each field of `Sampling` that is an option, with its words of `EFFECTS`."""
    dataset(Path("edges.h5"), "quad", duct(31, 15))
    Path("box.csv").write_text("0 0\n2 0\n3 1\n0 1\n")
    Path("body.csv").write_text("4 4\n4 5\n5 5\n6 3\n")
    Path("hole.csv").write_text("0 0\n9 0\n9 9\n0 9\n\n4 4\n4 5\n5 5\n5 4\n")
    base, made = [*run.split(), "-q", "-o"], Path("made.h5")
    assert meshonet(*base, "plain.h5").code == 0
    for option in sorted(OPTIONS - set(base)):
        done = meshonet(*base, made, *SHAPES[option][1].replace("OPTION", option).split())
        if done.code:
            assert (done.code, len(done.err.splitlines()), made.exists()) == (2, 1, False), done.err
            assert option in done.err
            remedy = done.err.partition("; ")[2]
            assert remedy.startswith(("leave --", "drop --", "use o or quad", "give one of them")), done.err
        else:
            assert nodes(made) != nodes(Path("plain.h5")), f"refuse {option}, or apply it"
            made.unlink()


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
