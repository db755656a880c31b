"""Statistics of quality metrics over the cells of a grid."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from meshonet.geometry.errors import meant


@dataclass(frozen=True)
class Summary:
    """Statistics of one metric over all cells, with percentiles if they were requested."""

    min: float
    mean: float
    max: float
    worst: tuple[int, ...]
    """The first cell with the worst value: (i, j), in multi-block grids (block, i, j) or (block, i, j, k)."""
    p01: float | None = None
    p99: float | None = None


@dataclass(frozen=True)
class Quality:
    """Quality of a grid: the numbers of cells and of folded cells, and every metric by its name.

    `bezier_folded` is the number of cells of a volume that may be folded inside, because a Bezier coefficient
    of the Jacobian is not positive. In the plane and on surfaces, `bezier_folded` is None.
    """

    cells: int
    folded: int
    metrics: Mapping[str, Summary]
    bezier_folded: int | None = None

    def __getitem__(self, name: str) -> Summary:
        """Return the statistics of a metric. Raises KeyError: an unknown one, with the known names."""
        if name not in self.metrics:
            known = f"{meant(str(name), self.metrics)}use one of {', '.join(self.metrics)}"
            raise KeyError(f"metric {name!r} is not known; {known}")
        return self.metrics[name]

    def __iter__(self) -> Iterator[str]:
        """Return an iterator over the names of the metrics."""
        return iter(self.metrics)

    def __str__(self) -> str:
        head = f"{self.cells} cells, {self.folded} folded\n{'metric':16}{'min':>12}{'mean':>12}{'max':>12}"
        rows = [f"{name:16}{s.min:12.4g}{s.mean:12.4g}{s.max:12.4g}" for name, s in self.metrics.items()]
        return "\n".join([head, *rows])


def named(at: tuple[int, ...]) -> str:
    """Return the indices of a node or cell as text: (i, j), (block, i, j) or (block, i, j, k).

    >>> named((3, 0, 7)), named((0, 1, 2, 3))
    ('block=3, i=0, j=7', 'block=0, i=1, j=2, k=3')
    """
    names = ("i", "j") if len(at) == 2 else ("block", "i", "j", "k")
    return ", ".join(map("{}={}".format, names, at))
