import pytest

from meshonet.formats.text.rows import MOST_BYTES, decode, left_out, read_lines, table
from meshonet.geometry.errors import InputError


def one(text: str) -> tuple[str, tuple[float, ...]]:
    (line,) = read_lines(text)
    return line.kind, line.values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1.0 0.5", (1, 0.5)),
        ("  1.0\t.5  ", (1, 0.5)),
        ("1.,-.5", (1, -0.5)),
        ("1.0 , 0.5,", (1, 0.5)),
        ("1;0.5", (1, 0.5)),
        ("1.0E+00 5.0d-01", (1, 0.5)),
        ("1.0D0 5Q-1", (1, 0.5)),
        ("1,0 0,5", (1, 0.5)),
        ("1,0;0,5", (1, 0.5)),
        ("1,5", (1, 5)),
        ("1.00000-0.50000", (1, -0.5)),
        ("(1.0, 0.5)", (1, 0.5)),
        ("1.0 (0.5)", (1, 0.5)),
        ("[1.0 0.5]", (1, 0.5)),
        ("1.0 0.5 # the edge", (1, 0.5)),
        ("1.0 0.5 ! the edge", (1, 0.5)),
        ("1 2 3", (1, 2, 3)),
        ("+1 -2", (1, -2)),
    ],
)
def test_numbers_are_read_as_people_write_them(text, values):
    assert one(text) == ("row", values)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", "blank"),
        (" \t ", "blank"),
        ("NACA 2412", "text"),
        ("2032c", "text"),
        ("64(1)-212", "text"),
        ("17", "text"),
        ("21.01.2003", "text"),
        ("# 1 2", "text"),
        ("0.99 -0.01 -> 0.99 -0.02", "text"),
        ("1.0 ......", "gap"),
        ("0.5 0.06 thickest", "noted"),
        ("0.5", "broken"),
        ("2032 section", "broken"),
        ("3x 0.05", "broken"),
        ("x.1 y.1", "text"),
        ("Inc. 0.5", "text"),
        ("1.0 ****", "damaged"),
        ("0.5 O.06", "damaged"),
        ("nan 0.1", "damaged"),
        ("0.5 nan", "damaged"),
        ("0.5 1e999", "damaged"),
        ("1e308 1e308", "damaged"),
        ("1_0 2_0", "damaged"),
        ("1.0 0.5 nan", "damaged"),
    ],
)
def test_what_is_no_row_is_told_apart(text, kind):
    assert one(text + "\n")[0] == kind


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_are_counted_as_editors_do(end):
    lines = read_lines(end.join(["a", "", "1 2", "3 4"]) + end)
    assert [(line.number, line.kind) for line in lines] == [(1, "text"), (2, "blank"), (3, "row"), (4, "row")]


def test_blocks_are_divided_by_blank_lines_and_prose():
    blocks = table(read_lines("t\n1 2\n3 4\n\n5 6\n7 ...\n8 9\nlower\n1 1\n"))
    assert [[line.values for line in block] for block in blocks] == [
        [(1, 2), (3, 4)],
        [(5, 6), (8, 9)],
        [(1, 1)],
    ]


def test_a_remark_behind_numbers_counts_beside_rows_only():
    rows = [
        line.number for block in table(read_lines("1 2 first\n3 4\n\nsee 5 6\n7 8 pages\n")) for line in block
    ]
    assert rows == [1, 2]


DAMAGED = (
    "1.000000 nan",
    "inf 0.000000",
    "1.000000 ********",
    "1e400 0.0",
    "1.0 O.O0",
    "1.0 0.0_00",
    "0.3x 0.05",
)


@pytest.mark.parametrize("row", DAMAGED)
@pytest.mark.parametrize("between", ["", "\n", "1.0 ...\n", "1e999 0\n"])
def test_a_row_that_cannot_be_read_is_refused_wherever_it_stands_beside_rows(row, between):
    good = "0.9 0.01\n0.8 0.02\n0.7 0.03\n"
    lines = {f"name\n{row}\n{between}{good}": 2, f"{good}{row}\n{between}{good}": 4, f"{good}{row}\n": 4}
    for text, number in lines.items():
        with pytest.raises(InputError, match=f"line {number}: .* is no pair of numbers; correct or remove"):
            table(read_lines(text))


def test_a_damaged_row_in_prose_does_not_matter_and_a_line_without_a_second_number_is_named():
    lines = read_lines("1.0 nan\nabout\n1 2\n3 4\n5 ...\n6 7\n0.5\n\n0.5\n")
    assert sum(map(len, table(lines))) == 3
    assert left_out(lines) == (
        "line 5, '5 ...', is no pair of numbers and is left out",
        "line 7, '0.5', is no pair of numbers and is left out",
    )


def test_a_broken_line_among_rows_is_refused_with_its_number():
    with pytest.raises(
        InputError, match=r"line 2: '0.5 O.06' is no pair of numbers; correct or remove the line"
    ):
        table(read_lines("1 0\n0.5 O.06\n0 0\n"))


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"\xef\xbb\xbf1 2", "1 2"),
        ("1 2 é".encode("utf-16"), "1 2 é"),
        ("é".encode(), "é"),
        (b"\xe9\xff", "éÿ"),
    ],
)
def test_any_text_is_decoded(data, text):
    assert decode(data) == text


@pytest.mark.parametrize(
    ("data", "message"),
    [(b"1 2\0", "binary data"), (b" " * (MOST_BYTES + 1), "too much for a file of points")],
)
def test_what_is_no_text_is_refused(data, message):
    with pytest.raises(InputError, match=message):
        decode(data)


def test_what_a_reader_does_to_its_lines_is_not_seen_by_the_next() -> None:
    text = "told once\n1 2\n3 4\n"
    first = read_lines(text)
    first.clear()
    one, other = read_lines(text), read_lines(text)
    assert [line.kind for line in one] == ["text", "row", "row"]
    assert one[1] is other[1], "lines of a text that is read again are kept"


def test_html_between_rows_is_named():
    page = "<pre>\n1 2\n3 4\n<p>ad</p>\nlower surface\n&nbsp;\n5 6\n</pre>\n"
    assert left_out(read_lines(page)) == (
        "line 4, '<p>ad</p>', is HTML and is left out",
        "line 6, '&nbsp;', is HTML and is left out",
    )
