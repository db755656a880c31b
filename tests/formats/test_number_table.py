import io

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from meshonet.formats.text.number_table import write_rows


def text(form: str, rows: NDArray[np.float64] | NDArray[np.int64]) -> list[str]:
    stream = io.BytesIO()
    write_rows(stream, form, rows)
    return stream.getvalue().decode("ascii").splitlines()


def oracle(values: NDArray[np.float64]) -> list[str]:
    return ["%.16e" % value for value in values.tolist()]  # noqa: UP031  (C's own spelling)


def test_every_power_of_ten_and_its_neighbours_are_rounded_as_c_rounds() -> None:
    powers = np.array([float(f"1e{k}") for k in range(-323, 309)])
    values = np.concatenate([powers, np.nextafter(powers, 0), np.nextafter(powers, np.inf)])
    assert text("%e", values[:, None]) == oracle(values)


def test_ties_zeros_and_the_ends_of_the_range_are_rounded_as_c_rounds() -> None:
    halves = np.arange(1, 2000) / 1024  # many end in a 5 that is exact
    whole = 2.0**60 + 256 * np.arange(2000)
    ends = np.array([0.0, -0.0, 5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, np.inf])
    values = np.concatenate([halves, -halves, whole, 2.0 ** np.arange(-1074, 1024), ends])
    assert text("%e", values[:, None]) == oracle(values)


def test_random_bits_are_rounded_as_c_rounds_and_come_back() -> None:
    bits = np.random.default_rng(0).integers(0, 2**64, 100_000, dtype=np.uint64)
    values = bits.view(np.float64)
    values = values[np.isfinite(values)]
    lines = text("%e", values[:, None])
    assert lines == oracle(values)
    assert np.array_equal(np.array(lines, float).view(np.uint64), values.view(np.uint64))


@given(st.lists(st.tuples(st.integers(-(2**63), 2**63 - 1), st.integers(-120, 120)), min_size=1))
def test_whole_numbers(rows: list[tuple[int, int]]) -> None:
    assert text("4(%d %d);", np.array(rows, np.int64)) == [f"4({a} {b});" for a, b in rows]


def test_many_rows_are_written_in_pieces() -> None:
    rows = np.arange(60_000).reshape(-1, 3)
    assert text("%d %d %d", rows) == [f"{a} {a + 1} {a + 2}" for a in range(0, 60_000, 3)]


def test_no_rows_write_nothing() -> None:
    assert text("%d", np.empty((0, 1), np.int64)) == []
