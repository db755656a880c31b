"""One command a file; this is their list, in the order of the help."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple


class Command(NamedTuple):
    """A command by its name and the first line of its help; its module is loaded when it is needed.

    The module of ``solve-pde`` is ``solve_pde``. It holds the function ``solve_pde`` and its ``EXAMPLES``,
    which a test runs.
    """

    name: str
    summary: str

    def loaded(self) -> tuple[Callable[..., Any], tuple[str, ...]]:
        """Return the function and the examples of its use."""
        name = self.name.replace("-", "_")
        module = import_module(f"{__name__}.{name}")
        return getattr(module, name), module.EXAMPLES


COMMANDS: tuple[Command, ...] = (
    Command("sample-boundary", "Turn geometry into boundaries of four edges."),
    Command("tfi", "Make grids by transfinite interpolation."),
    Command("solve-pde", "Make grids by elliptic equations, a variational method, or marching."),
    Command("train", "Fit a neural operator to datasets (needs the extra `train`)."),
    Command("infer", "Make the grid that measures best: conformal, marched or variational."),
    Command("layout", "Split domains into blocks and write these."),
    Command("stack", "Make volumes around wings, in ducts and blade rows, from sections."),
    Command("sweep", "Make volumes of pipes and ducts, cross-sections carried along curves."),
    Command("deform", "Make grids follow a changed boundary, their layers as they were."),
    Command("quality", "Measure grids: folded cells, angles, skewness."),
    Command("convert", "Turn files from one format into another."),
    Command("plot", "Draw grids, coloured by a quality metric."),
    Command("models", "List the operators that are shipped."),
    Command("doctor", "Say what is installed, whether it works, and what could be added."),
)
