import itertools

import numpy as np
import pytest

import meshonet
from meshonet.formats.source import Source
from meshonet.formats.text.airfoil_dat import parse, read_shapes, sniff
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.shape import edges_of
from meshonet.geometry.spacing.sampling import Sampling

X = np.array([0, 0.0125, 0.025, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0])
HALF = 0.6 * (0.2969 * np.sqrt(X) - 0.126 * X - 0.3516 * X**2 + 0.2843 * X**3 - 0.1036 * X**4)
MIDDLE = 0.08 * X * (1 - X)


def surfaces(base: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    half = np.where(X == 1, 0, HALF) + 0.5 * base * X
    return np.stack([X, MIDDLE + half], axis=1).round(6), np.stack([X, MIDDLE - half], axis=1).round(6)


def lines(points: np.ndarray, form: str = "{:.6f} {:.6f}") -> str:
    return "".join(form.format(*p) + "\n" for p in points)


UPPER, LOWER = surfaces()
SELIG = np.concatenate([UPPER[::-1], LOWER[1:]])
EXPECTED = Airfoil(SELIG)


def same(text: str, name: str = "TEST") -> None:
    """Hold the airfoil of a text to the one expected."""
    got = parse(text, "a.dat")
    np.testing.assert_allclose(got.curve.points, EXPECTED.curve.points, atol=1e-12)
    assert got.name == name


ORDERS = {
    "selig": lines(SELIG),
    "selig backwards": lines(SELIG[::-1]),
    "selig without its last point": lines(SELIG[:-1]),
    "from the leading edge round": lines(np.concatenate([UPPER, LOWER[-2::-1]])),
    "from the leading edge the other way": lines(np.concatenate([LOWER, UPPER[-2::-1]])),
    "lednicer": f" 15. 15.\n\n{lines(UPPER)}\n{lines(LOWER)}",
    "lednicer, lower side first": f"15 15\n{lines(LOWER)}{lines(UPPER)}",
    "lednicer with wrong counts": f" 17. 16.\n\n{lines(UPPER)}\n{lines(LOWER)}",
    "both from the leading edge, no counts": lines(UPPER) + "\n" + lines(LOWER),
    "both from the leading edge, nothing between": lines(UPPER) + lines(LOWER),
    "both from the trailing edge": lines(UPPER[::-1]) + "lower\n" + lines(LOWER[::-1]),
    "heading before each side": "Upper\n" + lines(UPPER[::-1]) + "Lower\n" + lines(LOWER[1:]),
    "a blank line behind each": lines(SELIG).replace("\n", "\n\n"),
    "every point twice": "".join(2 * line for line in lines(SELIG).splitlines(keepends=True)),
    "numbered": "".join(f"{k} {line}\n" for k, line in enumerate(lines(SELIG).splitlines(), start=1)),
    "with z": lines(SELIG, "{:.6f} {:.6f} 0.0"),
    "with another value": "".join(f"{x:.6f} {y:.6f} {x * y:.4f}\n" for x, y in SELIG),
    "x upper lower": "".join(
        f"{x:.6f} {a:.6f} {b:.6f}\n" for x, a, b in zip(X, UPPER[:, 1], LOWER[:, 1], strict=True)
    ),
    "both sides in a line": "".join(
        f"{lines([a])[:-1]} {lines([b])}" for a, b in zip(UPPER, LOWER, strict=True)
    ),
}


@pytest.mark.parametrize("order", ORDERS)
def test_every_order_gives_the_same_airfoil(order):
    same("TEST\n" + ORDERS[order])


DIALECTS = {
    "tabs": "{:.6f}\t{:.6f}",
    "commas": "{:.6f},{:.6f}",
    "semicolons": "{:.6f}; {:.6f}",
    "padded": "      {:.6f}      {:.6f}   ",
    "exponents": "{:.8E} {:.8E}",
    "brackets": "({:.6f}, {:.6f})",
    "signs": "{:+.6f} {:+.6f}",
    "remark": "{:.6f} {:.6f}  # point",
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_every_dialect_gives_the_same_airfoil(dialect):
    same("TEST\n" + lines(SELIG, DIALECTS[dialect]))
    same("TEST\n" + lines(SELIG, DIALECTS[dialect]).replace("E", "D").replace("\n", "\r\n"))


def test_decimal_commas_and_missing_zeros():
    same("TEST\n" + lines(SELIG).replace(".", ","))
    same("TEST\n" + lines(SELIG).replace("0.", "."))
    numbered = "".join(f"{k}\t{x:.6f}\t{y:.6f}\n" for k, (x, y) in enumerate(SELIG, start=1))
    same("TEST\n" + numbered.replace(".", ","))
    same("TEST\n" + lines(SELIG).replace("1.000000 0.000000", "1 0.0").replace(".", ","))


HEADS = {
    "": "a",
    "\n\n": "a",
    "NACA 64(1)-212 mod\n": "NACA 64(1)-212 mod",
    "23 012\n": "23 012",
    "2032c\n": "2032c",
    "0012\n": "0012",
    "# E 205  (10.48%)\n": "E 205 (10.48%)",
    "B737\n  -2.000 3.000 -2.646 3.454\n": "B737",
    "A\nmodel coordinates, not as designed\nFrom NASA TP-2890\n": "A",
    "T\n200000 4.5\n": "T",
    "T\n1.0000 ......\n": "T",
    "\x1b[31mred\n": r"\x1b[31mred",
}
TAILS = [
    "",
    "\n\n\nhttp://a.b/c?d=1\n",
    "\n21/12/2003\n12 5\n",
    "modif 0.99 -> 1.00\n0.1 0.2 -> 0.1 0.3\n",
    "\x1a",
    "ZZ\n",
    "999.0 999.0\n",
]


@pytest.mark.parametrize(("head", "tail"), list(itertools.product(HEADS, TAILS)))
def test_prose_before_and_behind_does_not_matter(head, tail):
    same(head + lines(SELIG) + tail, HEADS[head])


@pytest.mark.parametrize("order", ["selig", "lednicer", "labels"])
@pytest.mark.parametrize("unit", [1.0, 100.0, 1000.0])
def test_an_end_mark_is_no_point(order, unit):
    upper, lower = unit * UPPER, unit * LOWER
    data = {
        "selig": lines(unit * SELIG),
        "lednicer": f"15 15\n\n{lines(upper)}\n{lines(lower)}",
        "labels": f"Upper\n{lines(upper)}Lower\n{lines(lower)}",
    }[order]
    got = parse("TEST\n" + data + "999 999\n", "a.dat")
    np.testing.assert_allclose(got.curve.points, unit * EXPECTED.curve.points, atol=1e-9)


def test_four_points_are_an_airfoil_none_of_them_a_mark():
    points = np.array([[1, 0], [0.5, 0.1], [0, 0], [0.5, -0.1]])
    got = parse("Wedge\n" + lines(points), "wedge.dat")
    np.testing.assert_allclose(got.curve.points, points[[0, 3, 2, 1]], atol=1e-12)


def test_an_edge_far_behind_the_last_points_is_no_mistake():
    few, thin = (X < 0.85) | (X == 1), np.array([1.0, 0.1])
    upper, lower = thin * UPPER[few], thin * LOWER[few][:-1]
    got = parse(f"TEST\n{len(upper)} {len(lower)}\n{lines(upper)}{lines(lower)}", "a.dat")
    np.testing.assert_allclose(got.curve.points[0], [1.0, 0.0], atol=1e-12)
    assert len(got.curve.points) == len(upper) + len(lower) - 1


def test_units_and_position_stay():
    moved = 100 * SELIG @ np.array([[0.96, 0.28], [-0.28, 0.96]]) + [-7, 3]
    got = parse("in percent\n" + lines(moved, "{:.4f} {:.4f}"), "a.dat")
    np.testing.assert_allclose(got.trailing_edge, moved[0], atol=1e-3)
    assert got.chord == pytest.approx(100 * EXPECTED.chord, rel=1e-4)


@pytest.mark.parametrize("edge", [0.0, 0.002, 0.05, 0.1])
@pytest.mark.parametrize("between", ["", "\nlower\n"])
def test_both_surfaces_may_start_at_the_trailing_edge_round_or_not(edge, between):
    """A round edge is no sharper than the nose: which of the two it is, x tells."""
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 50)))
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    half += edge * np.sqrt(1 - x) * x
    upper, lower = (
        [f"{a:.6f} {b:.6f}\n" for a, b in zip(x, 0.03 * x * (1 - x) + side * half, strict=True)]
        for side in (1, -1)
    )
    selig = parse("".join([*upper[::-1], *lower[1:]]), "selig.dat")
    lednicer = parse("".join([*upper, "\n", *lower]), "lednicer.dat")
    both = parse("".join([*upper[::-1], between, *lower[::-1]]), "both.dat")
    first = parse("".join([*lower[::-1], between, *upper[::-1]]), "lower-first.dat")
    for result in (lednicer, both, first):
        np.testing.assert_array_equal(result.curve.points, selig.curve.points)


@pytest.mark.parametrize("base", [3e-4, 0.004, 0.1])
def test_a_blunt_edge_stays_blunt_in_lednicer_s_order(base):
    upper, lower = surfaces(base)
    got = parse(f"T\n15. 15.\n\n{lines(upper)}\n{lines(lower)}", "a.dat")
    assert got.blunt
    assert got.gap == pytest.approx(base, rel=1e-3)


def test_bytes_that_are_no_utf8_do_not_matter():
    (got,) = read_shapes(Source("a.dat", data=b"Profilw\xf6lbung \xff\n" + lines(SELIG).encode()))
    np.testing.assert_allclose(got.curve.points, EXPECTED.curve.points, atol=1e-12)
    assert got.name == "Profilwölbung ÿ"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.dat: 0 lines of coordinates; give an airfoil as lines of x y"),
        ("NACA 0012\n", "0 lines of coordinates"),
        ("T\n" + lines(UPPER), "the first and the last point lie .* chords apart; give both surfaces"),
        (
            "T\n" + lines(SELIG[:9]) + "0.35 0.0x9\n" + lines(SELIG[9:]),
            "a.dat: line 11: '0.35 0.0x9' is no pair",
        ),
        ("T\n" + lines(SELIG[:9]) + "4.05 0.09\n" + lines(SELIG[9:]), r"line 11: \(4.05, 0.09\) lies far"),
        ("T\n" + lines(SELIG) + lines(SELIG * 0.3 + [1.1, -0.1]), "more than once around"),
        ("T\n" + lines(SELIG * [1, 0]), "enclose no area"),
        ("T\n" + "1 0\n" * 20, "no extent"),
        ("T\n" + lines(SELIG * 1e90), "extent of"),
        ("T\n" + "1 0 0.5 0.5 2\n0.5 0.1 0.5 0.5 2\n0 0 0.5 0.5 2\n0 0.1 1 1 1\n", "5 columns"),
        ("T\n" + "0.5 0.1\n" * 30_000, "30000 points; an airfoil file has a few hundred"),
    ],
)
def test_files_that_hold_no_airfoil_are_refused_with_the_line(text, message):
    with pytest.raises(InputError, match=message):
        parse(text, "a.dat")


@pytest.mark.parametrize(
    ("counts", "note"),
    [
        ("15. 15.", ()),
        ("17. 16.", ("line 2 announces 17. 16. points and 15 and 15 follow, which are read",)),
        ("20 10", ("line 2 announces 20 10 points and 15 and 15 follow, which are read",)),
        ("0012 4", ()),
    ],
)
def test_wrong_counts_of_lednicer_s_order_are_a_note(counts, note):
    got = parse(f"TEST\n{counts}\n\n{lines(UPPER)}\n{lines(LOWER)}", "a.dat")
    assert got.notes == note
    *others, coarse = edges_of(got, Sampling(ni=41, nj=9)).notes
    assert (tuple(others), "the wall is a smooth curve" in coarse) == (note, True)


@pytest.mark.parametrize("row", ["1.000000 nan", "1.0 O.O0"])
def test_a_trailing_edge_that_cannot_be_read_is_refused_with_its_line(row):
    with pytest.raises(InputError, match=rf"a.dat: line 2: '{row}' is no pair of numbers; correct or remove"):
        parse(f"TEST\n{row}\n" + lines(SELIG[1:]), "a.dat")


def test_crossing_surfaces_are_named_by_their_lines(tmp_path):
    points = SELIG.copy()
    points[3, 1] = -0.1
    bad = tmp_path / "bad.dat"
    bad.write_text("T\n" + lines(points))
    with pytest.raises(InputError) as caught:
        meshonet.grid(str(bad))
    wanted = str(caught.value)
    assert wanted.startswith(f"{bad}: the surface crosses itself at (0.")
    assert "line 5" in wanted


def test_sniffing_knows_airfoils_from_other_text():
    assert sniff(("T\n" + lines(SELIG)).encode())
    assert not sniff(b"some prose\nonly\n")
    assert not sniff(b"2\n3 3\n" + b"1 2 3 4\n" * 9)
    assert not sniff(b"\0\1\2")


def test_what_is_read_can_be_sampled():
    b = parse("T\n" + lines(SELIG), "a.dat").boundary(Sampling(ni=61, nj=21))
    assert (b.ni, b.nj, b.topology, b.name) == (61, 21, "o", "T")


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("flatback 7%", "flatback 7%"),
        ("% plate %", "plate"),
        ("/* plate */", "plate"),
        ("## plate ##", "plate"),
    ],
)
def test_a_percent_sign_at_the_end_belongs_to_the_name_unless_it_marks_the_line(line: str, name: str) -> None:
    assert parse(f"{line}\n1 0\n.5 .05\n0 0\n.5 -.05\n1 0\n", "plate.dat").name == name
