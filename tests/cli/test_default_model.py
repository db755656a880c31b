"""Which model answers when none is named, and what is said where none can."""

from pathlib import Path

import pytest
from command_line import Meshonet


@pytest.mark.parametrize(
    ("polish", "model"), [("auto", None), ("off", "quad-general"), ("2", "quad-general")]
)
def test_steps_that_are_counted_follow_the_network(
    meshonet: Meshonet, duct_h5: Path, polish: str, model: str | None
) -> None:
    report = meshonet("infer", duct_h5, "--polish", polish, "-o", "g.vts", "--json").only
    assert report["model"] == model
    assert report["cycles"] == {"auto": report["cycles"], "off": 0, "2": 2}[polish]


C = ("naca:2412", "--topology", "c", "--res", "61x21", "-o", "g.vts")


@pytest.mark.parametrize(
    "words",
    [
        ("--model", "airfoil-o"),
        ("--model", "quad-general"),
        ("--model", "base"),
        ("--polish", "3"),
        ("--fallback",),
    ],
)
def test_c_grids_say_that_no_model_makes_them(meshonet: Meshonet, words: tuple[str, ...]) -> None:
    done = meshonet("infer", *C, *words)
    message = f"{' '.join(words)} is of no use to a c grid: it is marched, no model makes it; drop {words[0]}"
    assert (done.code, done.err) == (2, f"error: naca:2412: {message}\n")


def test_a_model_for_c_grids_is_known_not_to_be(meshonet: Meshonet) -> None:
    done = meshonet("infer", *C, "--model", "airfoil-c")
    assert done.code == 2
    assert done.err.startswith(
        "error: there is no model 'airfoil-c'; leave --model out: --topology c is marched"
    )


def test_a_file_that_is_no_model_is_told_before_what_it_would_make(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("infer", duct_h5, "--model", duct_h5, "-o", "g.vts")
    assert done.code == 2
    assert "duct.h5: not a safetensors file" in done.err
