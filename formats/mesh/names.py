"""Names as solvers' text files take them."""

from __future__ import annotations

import re
from collections.abc import Iterable


def words(
    names: Iterable[str], limit: int = 64, taken: Iterable[str] = (), *, letter: bool = False
) -> dict[str, str]:
    """Return a word of ASCII letters, digits and ``_.+-`` for each of `names`, all different.

    Solvers' case files name boundaries, and a blank, a comma or a bracket ends a name there.

    Parameters
    ----------
    limit : most characters of a word.
    taken : words that must not come out.
    letter : whether a word must start with a letter.

    Examples
    --------
    >>> words(["wall", "no-slip wall", "no-slip,wall", "Ω"])
    {'wall': 'wall', 'no-slip wall': 'no-slip_wall', 'no-slip,wall': 'no-slip_wall-2', 'Ω': 'part'}
    """
    found: dict[str, str] = {}
    used = set(taken)
    for name in names:
        if name in found:
            continue
        stem = re.sub(r"[^A-Za-z0-9_.+-]+", "_", name).strip("_.")[:limit] or "part"
        if letter and not stem[0].isalpha():
            stem = f"part_{stem}"[:limit]
        word, count = stem, 1
        while word in used:
            count += 1
            word = f"{stem[: limit - len(str(count)) - 1]}-{count}"
        found[name] = word
        used.add(word)
    return found
