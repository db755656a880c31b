"""What was measured of the cells of a grid: a summary of every metric."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from meshonet.geometry.errors import meant


@dataclass(frozen=True)
class Summary:
    """One metric over all cells; its percentiles, when they were asked for."""

    min: float
    mean: float
    max: float
    worst: tuple[int, ...]
    """The first cell (i, j) with the worst value; (block, i, j) or (block, i, j, k) in a grid of blocks."""
    p01: float | None = None
    p99: float | None = None


@dataclass(frozen=True)
class Quality:
    """Quality of a grid: how many cells it has, how many are folded, and every metric by name.

    `bezier_folded` counts the cells of volumes of which a Bezier coefficient of the Jacobian is not positive:
    those of folded corners, and those that may be folded inside. None in the plane and on surfaces.
    """

    cells: int
    folded: int
    metrics: Mapping[str, Summary]
    bezier_folded: int | None = None

    def __getitem__(self, name: str) -> Summary:
        """Return the summary of one metric.

        Raises KeyError: there is none of that name, with the names that there are.
        """
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
