"""Splits of a family: what is trained on, what is tested on."""

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.geometry.families.split import split

SHUFFLED = np.random.default_rng(1).permutation(np.linspace(-1.0, 2.0, 36)).tolist()


def chosen(way: str, **rest: object) -> list[float]:
    kept = split(SHUFFLED, way, **rest)  # type: ignore[arg-type]
    assert set(kept) == {"train", "test"}
    return sorted(value for value, use in zip(SHUFFLED, kept, strict=True) if use == "test")


def test_interpolation_trains_on_both_ends_and_tests_between() -> None:
    np.testing.assert_allclose(chosen("interpolation"), np.linspace(-1.0, 2.0, 36)[15:21])


def test_extrapolation_tests_one_end() -> None:
    np.testing.assert_allclose(chosen("extrapolation"), np.linspace(-1.0, 2.0, 36)[30:])
    np.testing.assert_allclose(chosen("extrapolation", low=True), np.linspace(-1.0, 2.0, 36)[:6])


def test_random_positions_depend_on_the_seed_alone() -> None:
    assert chosen("random") == chosen("random")
    assert chosen("random") != chosen("random", seed=1)
    assert len(chosen("random")) == 6


@pytest.mark.parametrize("way", ["interpolation", "extrapolation", "random"])
def test_three_members_leave_two_to_train_on(way: str) -> None:
    assert sorted(split([0.1, 0.2, 0.3], way)) == ["test", "train", "train"]


def test_what_cannot_be_split_is_refused() -> None:
    with pytest.raises(InputError, match="split 'halves' is not known; use interpolation, extrapolation"):
        split(SHUFFLED, "halves")
    with pytest.raises(InputError, match="2 members cannot be split; give at least 3"):
        split([0.1, 0.2], "random")
    for members in ([0.3, 0.3, 0.3], [0.1, np.nan, 0.2]):
        with pytest.raises(InputError, match="without different parameters have no interpolation"):
            split(members, "interpolation")


def test_a_random_split_needs_no_parameters() -> None:
    assert sorted(split([np.nan] * 12, "random")) == ["test"] * 2 + ["train"] * 10


def test_the_paper_extrapolates_two_families_to_low_values() -> None:
    assert [name for name in FAMILIES if family(name).to_low] == ["hexagon", "wrench"]
