"""How a file was made, as facts that travel in it."""

import shlex
import sys
from collections.abc import Sequence
from functools import lru_cache

from meshonet import __version__


def provenance(arguments: Sequence[str] | None = None) -> dict[str, str]:
    """Return the program's version and command line, without the output's name.

    The name is left out so that the same input and settings give the same bytes wherever they are written.

    `arguments`: of the program, its name not among them; None means those it was started with.

    >>> provenance(["tfi", "a b.csv", "-o", "grid.vts", "--res", "80"])["command"]
    "meshonet tfi 'a b.csv' --res 80"
    """
    line = tuple(sys.argv[1:] if arguments is None else arguments)
    return {"software": f"meshonet {__version__}", "command": _command(line)}


@lru_cache(maxsize=1)  # every grid of many files has the same, and it names all of them
def _command(words: tuple[str, ...]) -> str:
    kept = ["meshonet"]
    taken = iter(words)
    for word in taken:
        if word in ("-o", "--output"):
            next(taken, None)
        elif not (word.startswith("--output=") or (word.startswith("-o") and len(word) > 2)):
            kept.append(word)
    return shlex.join(kept)
