"""Members of a family of shapes as inputs of a batch."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from meshonet.geometry.families.draw import Draw


@dataclass(frozen=True)
class DrawnInputs:
    """Shapes drawn from a family as inputs: with the `shard` (k, n), every n-th from the k-th on."""

    draws: Sequence[Draw]
    shard: tuple[int, int] = (1, 1)

    def own(self) -> Iterator[Draw]:
        """Yield the inputs of this job: with the `shard` (k, n), every n-th shape from the k-th on."""
        k, n = self.shard
        return map(self.draws.__getitem__, range(k - 1, len(self.draws), n))

    def count(self) -> int:
        """Return the approximate number of shapes of this job."""
        return len(self.draws) // self.shard[1]

    def parts(self, size: int) -> Iterator[tuple[int, tuple[Draw, ...]]]:
        """Yield index and shapes of each part that this job makes; parts have at most `size` shapes."""
        k, n = self.shard
        for number in range(k - 1, -(-len(self.draws) // size), n):
            yield number, tuple(self.draws[number * size : (number + 1) * size])

    def more_than(self, count: int) -> bool:
        """Return whether there are more than `count` shapes in all jobs together."""
        return len(self.draws) > count
