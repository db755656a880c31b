"""What commands print, compared with what a page shows: words exactly, figures to the digits that are shown.

Whole numbers are promises and are equal. Others may differ by a unit of their last digit: rounding differs
from processor to processor. Times are let pass, and where a worst cell is: others may be as bad.
"""

import re
from decimal import Decimal

_TIME = re.compile(r"\d[\d.]* (ms|s|min)\b")
_PLACE = re.compile(r"\b(block|i|j|k)=\d+|(?<=\s)\d+(?:, \d+)+(?=\s|$)")
_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w])")


def differences(expected: str, printed: str, within: float = 0.0) -> list[str]:
    """Return how the lines of a page differ from those that were printed; nothing for a page that is true.

    A line ``...`` of the page stands for any lines. Empty lines do not count. Figures with a point may also
    differ by the part `within` of them: those of a network, which training makes another on another machine.
    """
    lines = [line for line in printed.splitlines() if line.strip()]
    at, gap, unlike = 0, False, []
    for line in filter(str.strip, expected.splitlines()):
        if line.strip() == "...":
            gap = True
            continue
        nexts = range(at, len(lines) if gap else min(at + 1, len(lines)))
        alike = [k for k in nexts if _words(line) == _words(lines[k])]
        equal = [k for k in alike if not _other_figures(line, lines[k], within)]
        if not equal:
            nearest = [lines[k] for k in alike] or [*lines[at : at + 1], "nothing more"]
            figures = _other_figures(line, nearest[0], within) if alike else []
            unlike.append(_difference(line, nearest[0], figures))
        if hits := equal or alike:
            at, gap = hits[0] + 1, False
    extra = [] if gap or unlike or not expected.strip() else lines[at:]
    return unlike + [f"not on the page: {line}" for line in extra]


def same_figure(shown: str, printed: str, within: float = 0.0) -> bool:
    """Return whether figures are equal, or at most a unit of the last digit apart where they have a point.

    The last digit is that of the longer one: zeros at the end may have been left out.
    """
    first, second = Decimal(shown), Decimal(printed)
    if "." not in shown + printed:
        return first == second
    last = min(int(number.as_tuple().exponent) for number in (first, second))
    return abs(first - second) <= max(Decimal(1).scaleb(last), Decimal(within) * abs(first))


def _difference(shown: str, printed: str, figures: list[tuple[str, str]]) -> str:
    named = [f"figure:  {one} is shown, {other} is printed" for one, other in figures]
    return "\n".join([f"shown:   {shown.strip()}", f"printed: {printed.strip()}", *named])


def _other_figures(shown: str, printed: str, within: float) -> list[tuple[str, str]]:
    pairs = zip(*(_NUMBER.findall(_plain(line)) for line in (shown, printed)), strict=True)
    return [pair for pair in pairs if not same_figure(*pair, within)]


def _words(line: str) -> str:
    return _NUMBER.sub("#", _plain(line))


def _plain(line: str) -> str:
    """Return a line without times, places and spaces that line up columns."""
    return _PLACE.sub("PLACE", _TIME.sub("TIME", " ".join(line.split())))
