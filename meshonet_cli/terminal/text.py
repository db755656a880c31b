"""Numbers and tables as text."""

from collections.abc import Sequence

from meshonet.formats.source import printable

_BAR_LENGTH = 24  # number of characters of a progress bar


def aligned(rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Return `rows` as aligned lines: the first `left` columns are flush left, all others flush right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = [*map(str.ljust, row[:left], widths), *map(str.rjust, row[left:], widths[left:])]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def quoted(text: str) -> str:
    r"""Return a text in which escape sequences (of file names) cannot control the terminal.

    >>> print(quoted("a\x1b[31m.dat\nb"))
    a\x1b[31m.dat
    b
    """
    return text if text.isprintable() else "\n".join(map(printable, text.split("\n")))


def figure(value: float) -> str:
    """Return a number in the form that tables have.

    >>> figure(90.12345), figure(0.000123456), figure(1234567.0), figure(0.0)
    ('90.12', '0.0001235', '1.235e+06', '0')
    """
    return f"{value:.4g}"


def span(seconds: float) -> str:
    """Return a computing time as text, in seconds or milliseconds."""
    return f"{seconds:.2f} s" if seconds >= 1 else f"{1e3 * seconds:.1f} ms"


def duration(seconds: float) -> str:
    """Return a remaining time as text, in seconds, minutes or hours.

    >>> duration(42.0), duration(600.0), duration(9000.0)
    ('42 s', '10 min', '2.5 h')
    """
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def bar(done: int, count: int) -> str:
    """Return a progress bar that is filled to `done` of `count` parts.

    >>> bar(1, 4)
    '[######------------------]'
    """
    filled = _BAR_LENGTH * done // count
    return f"[{'#' * filled}{'-' * (_BAR_LENGTH - filled)}]"
