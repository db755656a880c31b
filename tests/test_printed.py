"""What is printed is compared with a page by words, and by figures to the digits that the page shows."""

import pytest
from printed import differences


@pytest.mark.parametrize(
    ("shown", "printed"),
    [
        ("cells 100", "cells 100"),
        ("angle 90.1", "angle 90.0"),
        ("angle 90", "angle 89.99"),
        ("cd 0.0129", "cd 0.0130"),
        ("cd 0.013", "cd 0.0129"),
        ("residual 1e-05", "residual 9.9e-06"),
        ("residual 4.8e-05", "residual 4.7e-05"),
        ("time 12 ms: read 1.5 ms", "time 1.2 s: read 950 ms"),
        ("131.0 degrees at i=197, j=0", "131.0 degrees at i=2, j=0"),
        ("box_ratio 231 12, 13, 0 pass", "box_ratio 231 2, 3, 1 pass"),
        ("a  b", "a b"),
        ("a\n\nb", "a\nb"),
        ("a\n...\nb", "a\nx\ny\nb"),
        ("a\n...", "a\nb"),
        ("", "what the page does not show"),
    ],
)
def test_a_page_is_true_to_the_digits_that_it_shows(shown: str, printed: str) -> None:
    assert differences(shown, printed) == []


@pytest.mark.parametrize(
    ("shown", "printed"),
    [
        ("cells 1000", "cells 1001"),
        ("folded 0", "folded 1"),
        ("angle 90.1", "angle 89.9"),
        ("angle 90", "angle 89.9888"),
        ("cd 0.0129", "cd 0.0131"),
        ("cd 0.1", "cd 0.1999"),
        ("Re 1e+06", "Re 2e+06"),
        ("residual 4.8e-05", "residual 4.6e-05"),
        ("residual 4.8e-05", "residual 4.8e-06"),
        ("cells 100", "nodes 100"),
        ("naca2412", "naca2413"),
        ("200x100", "200x101"),
        ("a\nb", "a\nx\nb"),
        ("a\n...\nb", "a\nx"),
        ("a", "a\nb"),
        ("a\nb", "a"),
        ("a", ""),
    ],
)
def test_a_page_that_shows_something_else_is_not_true(shown: str, printed: str) -> None:
    assert differences(shown, printed) != []


def test_figures_of_a_network_may_differ_by_a_part_and_whole_numbers_may_not() -> None:
    assert differences("rel 0.002116 of 100", "rel 0.002111 of 100", within=0.02) == []
    assert differences("worst 172", "worst 171.9", within=0.02) == []
    assert differences("rel 0.002116 of 100", "rel 0.00206 of 100", within=0.02) != []
    assert differences("rel 0.002116 of 100", "rel 0.002116 of 101", within=0.02) != []


def test_a_difference_has_both_lines_and_the_figure() -> None:
    shown = "grid 20 x 10\n...\nangle  90.1, mean 45.0\nfolded 0"
    printed = "grid 20 x 10\nread\nangle  90.1, mean 45.2\nfolded 0"
    (difference,) = differences(shown, printed)
    assert difference.splitlines() == [
        "shown:   angle  90.1, mean 45.0",
        "printed: angle  90.1, mean 45.2",
        "figure:  45.0 is shown, 45.2 is printed",
    ]


def test_a_difference_of_words_has_the_line_in_its_place() -> None:
    assert differences("a\nb 1", "a\nc 2") == ["shown:   b 1\nprinted: c 2"]
    assert differences("a\nb", "a") == ["shown:   b\nprinted: nothing more"]
