"""The list of commands in the order of the help; each command has a module."""

from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
from typing import Any, NamedTuple


class Command(NamedTuple):
    """Name and summary of a command; its module is loaded when needed.

    For instance, ``solve-pde`` is the function ``solve_pde`` of the module ``solve_pde``.
    """

    name: str
    summary: str

    def loaded(self) -> tuple[Callable[..., Any], tuple[str, ...]]:
        """Return the function of the command and examples of its use."""
        name = self.name.replace("-", "_")
        module = import_module(f"{__name__}.{name}")
        return getattr(module, name), module.EXAMPLES


COMMANDS: tuple[Command, ...] = (
    Command("sample-boundary", "Place nodes on the four edges of a boundary."),
    Command("tfi", "Make grids by transfinite interpolation."),
    Command("solve-pde", "Make elliptic, variational or marched grids."),
    Command("train", "Train a neural operator on datasets."),
    Command("infer", "Make grids by the method that suits the kind of shape."),
    Command("layout", "Split domains into blocks and write the block layout."),
    Command("stack", "Make volume grids of wings, ducts, blade rows and aircraft."),
    Command("sweep", "Sweep cross-sections along curves: pipes and ducts."),
    Command("deform", "Deform grids to fit changed walls; layers are kept."),
    Command("quality", "Measure quality: folded cells, angles, growth."),
    Command("convert", "Convert files from one format to another."),
    Command("plot", "Draw grids, coloured by a quality metric."),
    Command("models", "List the neural operators that are part of meshonet."),
    Command("doctor", "Check the installation and list what is missing."),
)
BY_NAME = dict(zip(map(attrgetter("name"), COMMANDS), COMMANDS, strict=True))
