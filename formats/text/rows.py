"""Lines of a text file of coordinates, classified as numbers, prose or damaged.

Numbers: ``0.5``, ``.5``, ``5e-1``, ``5.0D-01``, ``(0.5)``, ``0,5`` without other commas, ``0.5-0.01``.
"""

import re
from functools import lru_cache
from itertools import count
from operator import attrgetter
from typing import Literal, NamedTuple

from meshonet.formats.source import LARGEST
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change

Kind = Literal["blank", "text", "row", "noted", "gap", "broken", "damaged"]
MOST_BYTES = 16 * 2**20  # largest file that is read; larger ones are taken for a mistake
MOST_LINES = 300_000  # largest number of lines, so that a file of line ends is rejected at once
_REMEMBERED = 200_000  # longest text, in characters, whose lines are kept for the next reader
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdDqQ][+-]?\d+)?"  # a number in the notation of C or Fortran
_ONE = re.compile(_NUMBER)
_FUSED = re.compile(r"([+-]?\d*\.\d+(?:[eEdD][+-]?\d+)?)([+-]\d*\.\d+(?:[eEdD][+-]?\d+)?)")
"""Two numbers without a separator."""
_COMMA = re.compile(r"[+-]?(?:\d*,)?\d+(?:[eEdD][+-]?\d+)?")  # a number with a decimal comma
_SPLIT = re.compile(r"[\s,;]+")  # separators of columns
_PLACEHOLDER = re.compile(r"[._?-]{2,}|-")  # dots or dashes in place of a number
_MEANT = re.compile(
    r"[+-]?(?:nan|inf(?:inity)?|\*{2,}|(?=[^.]*\.?\w*\d)[\dOolI]*\.[\w.]*(?:e[+-]?\w+)?|\d+(?:_\d+)+)",
    re.IGNORECASE,
)
"""A word meant as a number: not finite, Fortran's stars, or digits among other characters."""
_HTML = re.compile(r"</?[a-z!][^<>]*>|&#?\w+;", re.IGNORECASE)  # a tag or an entity
_REMARK = re.compile(r"\s(?:#|!|//|<-).*$|^\s*(?:#|!|//).*$")


class Line(NamedTuple):
    """One line of a text: its number (from 1), its kind, its values if it is a row, and its text.

    The kinds are:

    - ``row``: two or more numbers and nothing else;
    - ``noted``: two numbers, then words;
    - ``gap``: a number, then dots in place of the next;
    - ``damaged``: two words meant as numbers, one of them invalid (``1.0 nan``, ``1.0 ****``, ``1.0 O.O0``);
    - ``broken``: a number alone, or together with other text;
    - ``text``: all other lines.
    """

    number: int
    kind: Kind
    values: tuple[float, ...]
    text: str


def decode(data: bytes) -> str:
    r"""Return bytes as text; they are UTF-8, UTF-16 with a byte-order mark, or else Latin-1.

    Raises InputError if there are more than `MOST_BYTES`, or if zero bytes show that it is no text.

    Examples
    --------
    >>> decode(b"\xef\xbb\xbf1 2"), decode("Stéfan".encode("latin-1"))
    ('1 2', 'Stéfan')
    """
    if len(data) > MOST_BYTES:
        problem = f"{len(data) // 2**20} MB are too much for a file of points"
        raise InputError(problem, "give a file below 16 MB")
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    if b"\0" in data:
        remedy = "name its format with {from_format}, or give a text file"
        raise InputError("holds binary data, not text", remedy)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def read_lines(text: str) -> list[Line]:
    r"""Return the lines of a text, each with its kind (see `Line`).

    Examples
    --------
    >>> [(line.kind, line.values) for line in read_lines("NACA 1\n1.0 0.0\n.5\t(0.1D-1)\n")]
    [('text', ()), ('row', (1.0, 0.0)), ('row', (0.5, 0.01))]
    """
    return list(_lines(text) if len(text) <= _REMEMBERED else _lines.__wrapped__(text))


@lru_cache(maxsize=1)  # what finds out the format reads the same text as the format itself
def _lines(text: str) -> tuple[Line, ...]:
    texts = re.split(r"\r\n|\r|\n", text.replace("\x1a", ""))
    if texts and not texts[-1]:
        texts.pop()
    if len(texts) > MOST_LINES:
        problem = f"{len(texts)} lines are too many for a file of points"
        raise InputError(problem, f"give at most {MOST_LINES}")
    return tuple(map(_line, count(1), texts))


def mostly_rows(head: bytes, counts: tuple[int, ...], least: int) -> bool:
    """Return whether at least `least` rows, and 80 % of all rows, contain a permitted count of numbers."""
    try:
        lines = read_lines(decode(head))
    except InputError:
        return False
    rows = fitting = 0
    for line in lines:
        rows += line.kind == "row"
        fitting += line.kind == "row" and len(line.values) in counts
    return fitting >= least and fitting >= 0.8 * rows


def table(lines: list[Line]) -> list[list[Line]]:
    """Return the rows (lines of numbers) of a text, divided into blocks by blank lines and prose.

    A line of two numbers and then words is a row only if the line above or below has numbers alone. Raises
    InputError at a line among rows that looks like a damaged row.
    """
    kinds: list[Kind] = ["blank", *map(attrgetter("kind"), lines), "blank"]
    blocks: list[list[Line]] = [[]]
    for k, line in enumerate(lines):
        beside = kinds[k], kinds[k + 2]
        if line.kind == "row" or (line.kind == "noted" and "row" in beside):
            blocks[-1].append(line)
        elif (line.kind == "broken" and beside == ("row", "row")) or (
            line.kind == "damaged" and "row" in (_next_kind(kinds, k + 1, -1), _next_kind(kinds, k + 1, 1))
        ):
            problem = f"{line.text.strip()[:40]!r} is no pair of numbers"
            raise InputError(problem, "correct or remove the line", place=f"line {line.number}")
        elif line.kind != "gap" and blocks[-1]:
            blocks.append([])
    return blocks if blocks[-1] else blocks[:-1]


def _next_kind(kinds: list[Kind], k: int, step: int) -> Kind:
    """Return the kind of the next line in direction `step` from line `k` that is a row or prose."""
    while 0 < (k := k + step) < len(kinds) - 1:
        if kinds[k] in ("row", "text"):
            return kinds[k]
    return "blank"


def left_out(lines: list[Line]) -> tuple[str, ...]:
    """Return notes on ignored lines: HTML among rows of numbers, and damaged lines directly beside a row."""
    kinds: list[Kind] = ["blank", *map(attrgetter("kind"), lines), "blank"]
    notes, first, last = [], 0, 0
    if "row" in kinds:
        first, last = kinds.index("row"), len(kinds) - 1 - kinds[::-1].index("row")
    for k, line in enumerate(lines):
        what = ""
        if line.kind in ("gap", "broken") and "row" in (kinds[k], kinds[k + 2]):
            what = "no pair of numbers"
        elif line.kind == "text" and first < k + 1 < last and _HTML.search(line.text):
            what = "HTML"
        if what:
            notes.append(Change(f"line {line.number}, {line.text.strip()[:40]!r}, is {what} and is left out"))
    return tuple(notes)


def _line(number: int, text: str) -> Line:
    words = text.split()
    if len(words) == 2:  # the usual line, without any of the rest
        try:
            pair = float(words[0]), float(words[1])
        except ValueError:
            pass
        else:
            if abs(pair[0]) < LARGEST and abs(pair[1]) < LARGEST and "_" not in text:
                return Line(number, "row", pair, text)
    if not words:
        return Line(number, "blank", (), text)
    bare = _REMARK.sub("", text).strip() if len(text) <= 4000 else ""
    if not bare or (bare[0].isalpha() and not _MEANT.fullmatch(_SPLIT.split(bare, maxsplit=1)[0])):
        return Line(number, "text", (), text)
    return _difficult(number, text, _words(bare))


def _words(text: str) -> list[str]:
    """Return the words between separators; decimal commas become points."""
    blank = re.split(r"[\s;]+", text.strip(" \t,;"))
    if len(blank) > 1 and "," in text and "." not in text and all(map(_COMMA.fullmatch, blank)):
        return [word.replace(",", ".") for word in blank]
    words = []
    for word in _SPLIT.split(text.strip(" \t,;")):
        fused = _FUSED.fullmatch(word)
        words += list(fused.groups()) if fused else [word] if word else []
    return words


def _difficult(number: int, text: str, words: list[str]) -> Line:
    bare = [
        word.strip("()[]{}\"'") if word[0] in "([{\"'" or word[-1] in ")]}\"'" else word for word in words
    ]
    values: list[float] = []
    for word in bare:
        value = float(re.sub("[dDqQ]", "e", word)) if _ONE.fullmatch(word) else LARGEST
        if not abs(value) < LARGEST:
            break
        values.append(value)
    if len(values) == len(bare) > 1:
        return Line(number, "row", tuple(values), text)
    numbers = bare[:2] if len(values) < 2 else bare
    if len(bare) > 1 and all(_MEANT.fullmatch(word) or _ONE.fullmatch(word) for word in numbers):
        return Line(number, "damaged", (), text)
    if len(values) == 2 and not re.search(r"[\d>=:/]", " ".join(words[2:])):
        return Line(number, "noted", tuple(values), text)
    if len(values) == 1 and len(bare) == 1:
        return Line(number, "broken" if "." in text else "text", (), text)
    if len(values) == 1:
        return Line(number, "gap" if _PLACEHOLDER.fullmatch(bare[1]) else "broken", (), text)
    begun = len(bare) == 2 and bare[0][:1] in "0123456789.+-" and _ONE.fullmatch(bare[1])
    return Line(number, "broken" if begun and not values else "text", (), text)
