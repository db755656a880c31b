"""Provenance of a file: version and command, stored in the file."""

import shlex
import sys
from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby

from meshonet import __version__

_MOST_NAMED = 12  # words between options that are all kept


def provenance(arguments: Sequence[str] | None = None) -> dict[str, str]:
    """Return version and command line of the program; the command line is without the name of the output.

    `arguments` are without the program's name; None: the arguments of this process.

    >>> provenance(["tfi", "a b.csv", "-o", "grid.vts", "--res", "80"])["command"]
    "meshonet tfi 'a b.csv' --res 80"
    """
    line = tuple(sys.argv[1:] if arguments is None else arguments)
    return {"software": f"meshonet {__version__}", "command": _command(line)}


def abridged(words: Sequence[str]) -> list[str]:
    """Return a command line with long lists of inputs shortened, as it is stored in the grids of a dataset.

    >>> abridged(["tfi", *(f"{k}.csv" for k in range(40)), "--res", "80"])
    ['tfi', '0.csv', '[38 more]', '39.csv', '--res', '80']
    """
    kept: list[str] = []
    for option, run in groupby(words, lambda word: word.startswith("-")):
        names = list(run)
        long = not option and len(names) > _MOST_NAMED
        kept += [*names[:2], f"[{len(names) - 3} more]", names[-1]] if long else names
    return kept


@lru_cache(maxsize=1)
def _command(words: tuple[str, ...]) -> str:
    kept = ["meshonet"]
    taken = iter(abridged(words) if len(words) > _MOST_NAMED else words)
    for word in taken:
        if word in ("-o", "--output"):
            next(taken, None)
        elif not (word.startswith("--output=") or (word.startswith("-o") and len(word) > 2)):
            kept.append(word)
    return shlex.join(kept)
