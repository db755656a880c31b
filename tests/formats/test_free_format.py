"""Numbers out of text: the doubles that Python's own parser makes, to the last bit."""

import struct
from random import Random

import numpy as np
import pytest

from meshonet.formats.text.number_table import leading_numbers


@pytest.mark.parametrize("form", ["{:.16e}", "{:.15g}", "{:.7e}", "{:.17f}", "{:.20e}", "{:.3f}", "{!r}"])
def test_every_bit_is_that_of_python(form: str) -> None:
    random = Random(form)  # noqa: S311  (no secret)
    sizes = [random.uniform(-1, 1) * 10 ** random.randint(-12, 12) for _ in range(2000)]
    bits = (struct.unpack("<d", random.randbytes(8))[0] for _ in range(2000))
    words = [form.format(x) for x in (*sizes, *(x for x in bits if 1e-270 < abs(x) < 1e280))]
    values, stop = leading_numbers(" ".join(words).encode())
    assert stop == len(" ".join(words))
    assert values.tolist() == [float(word) for word in words]


def test_halves_are_rounded_to_even_or_left_to_others() -> None:
    for whole in (2**53 + 1, 2**53 + 3, 2**54 + 2, 2**60 + 2**7, 10**22 + 1, 9007199254740993 * 2):
        values, stop = leading_numbers(str(whole).encode())
        assert values.tolist() == [float(whole)] or (len(values), stop) == (0, 0)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        (b"1,2;3\t4\r\n5\x1a6", [1, 2, 3, 4, 5, 6]),
        (b" -0. +.5 5. 1d3 1.5Q+2 2D-1", [-0.0, 0.5, 5, 1000, 150, 0.2]),
        (b"0.1234-102 9+1", [1.234e-103, 90]),
        (b"12345678901234567890123 0.000000000000000000000000000001", [12345678901234567890123, 1e-30]),
        (b"", []),
        (b"   ", []),
    ],
)
def test_fortran_spells_numbers_freely(text: bytes, values: list[float]) -> None:
    result, stop = leading_numbers(text)
    assert result.tolist() == [float(value) for value in values]
    assert stop == len(text)


@pytest.mark.parametrize(
    "word", [b"nan", b"3*1", b"1e", b"e5", b".", b"-", b"1..2", b"0x1", b"1e99999", b"\x1b[2J"]
)
def test_it_stops_before_a_word_that_is_no_number(word: bytes) -> None:
    result, stop = leading_numbers(b"1 2 " + word + b" 3")
    assert (result.tolist(), stop) == ([1, 2], 4)


def test_it_stops_when_it_has_enough() -> None:
    result, stop = leading_numbers(b"1 2 3 4 5", 2, 2)
    assert (result.tolist(), stop) == ([2, 3], 6)
    assert np.array_equal(leading_numbers(b"7 8", 5)[0], [7, 8])
