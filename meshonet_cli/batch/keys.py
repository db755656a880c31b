"""Keys of the samples of a dataset: stems of files, each once."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from meshonet.formats.hdf5.names import UniqueNames
from meshonet.formats.inputs import is_dataset
from meshonet.formats.registry import is_designation
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.item import Item


class Keys:
    """Names of samples, each unique in a dataset or in a part of one."""

    def __init__(self) -> None:
        self._names = UniqueNames()

    def named(self, item: Item[Any], what: Any) -> Any:
        """Return a grid or boundary with a unique name; the old name becomes its title if it has no title."""
        if not isinstance(what, Grid | Boundary):
            return what
        key = self._names.add(item.stem if _of_file(item) else what.name)
        if key == what.name:
            return what
        return replace(what, name=key, origin=replace(what.origin, title=what.origin.title or what.name))


def _of_file(item: Item[Any]) -> bool:
    """Return whether a member is all of a file that is not a dataset."""
    source = item.source
    if not item.only or source == "-" or is_designation(source) or is_dataset(source):
        return False
    return bool(item.called or Path(source).suffix) or Path(source).is_file()
