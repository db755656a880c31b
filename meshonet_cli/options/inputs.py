"""Options that say which inputs of many are taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from meshonet_cli.options.groups import IO, bad_value, option_of

if TYPE_CHECKING:
    from meshonet.formats.inputs import Inputs

_option = option_of(IO)


# fmt: off
@dataclass(frozen=True)
class InputOptions:
    """Which inputs are taken of folders, zip archives and lists, and which of all inputs."""

    pick: Annotated[list[str] | None, _option(
        "--pick", metavar="PATTERN",
        help="Of folders, .zip files and lists take files of these names only, e.g. 'naca*'; case does not "
        "matter. Can be repeated.",
    )] = None
    shard: Annotated[str | None, _option(
        "--shard", metavar="K/N",
        help="Take every N-th input from the K-th on, for N jobs that share the work; of a dataset in parts, "
        "every N-th part.",
    )] = None
# fmt: on

    def of(self, words: Sequence[str], *, grids: bool = False, suffixes: Sequence[str] = ()) -> Inputs:
        """Return the inputs that `words` name: shapes, or `grids`, or files of other endings.

        Raises InputError: as `Inputs`; a shard that is none.
        """
        from meshonet.formats.inputs import Inputs, readable_suffixes

        endings = frozenset(suffixes) or readable_suffixes(grids_only=grids)
        return Inputs(tuple(words), endings, tuple(self.pick or ()), self.part())

    def part(self) -> tuple[int, int]:
        """Return K and N of the shard, 1 and 1 for all inputs. Raises InputError: it is none."""
        if self.shard is None:
            return 1, 1
        words = self.shard.split("/")
        if len(words) != 2 or not all(word.isascii() and word.isdigit() and len(word) < 10 for word in words):
            raise bad_value(self.shard, "a shard", "use K/N, e.g. 3/8 for the third of eight", "shard")
        return int(words[0]), int(words[1])
