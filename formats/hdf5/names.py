"""Names of the samples of a dataset, each once."""


class UniqueNames:
    """Names for the samples of a dataset: a repeated name gets a number; empty names stay empty.

    >>> names = UniqueNames()
    >>> [names.add(name) for name in ("tip", "root", "tip", "", "", "tip")]
    ['tip', 'root', 'tip-2', '', '', 'tip-3']
    """

    def __init__(self) -> None:
        self._last: dict[str, int] = {}  # number of the last sample of each name

    def add(self, name: str) -> str:
        """Return `name`, with a number appended if another sample has it; an empty name stays empty."""
        unique, number = name, self._last.get(name, 1)
        while name and unique in self._last:
            number += 1
            unique = f"{name}-{number}"
        self._last[name] = number
        self._last.setdefault(unique, 1)
        return unique
