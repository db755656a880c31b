"""Structured, body-fitted grids from a boundary.

    import meshonet

    grid = meshonet.grid("naca:0012", res=(250, 100), y_plus=1, reynolds=6e6)
    grid.quality()["max_angle"].max
    grid.write("naca0012.cgns")

Functions have the names of the commands, and parameters those of the options, with underscores.
"""

from importlib import import_module
from itertools import chain
from typing import TYPE_CHECKING, Any

from meshonet.above import ABOVE

if TYPE_CHECKING:
    from meshonet.api.convert import convert as convert
    from meshonet.api.deform import deform as deform
    from meshonet.api.deform import rotation as rotation
    from meshonet.api.derivatives import deform_derivative as deform_derivative
    from meshonet.api.derivatives import optimum_derivative as optimum_derivative
    from meshonet.api.doctor import doctor as doctor
    from meshonet.api.files import inputs as inputs
    from meshonet.api.files import read as read
    from meshonet.api.files import read_all as read_all
    from meshonet.api.files import write as write
    from meshonet.api.grid import grid as grid
    from meshonet.api.grid import infer as infer
    from meshonet.api.grid import sample_boundary as sample_boundary
    from meshonet.api.grid import sample_family as sample_family
    from meshonet.api.grid import solve_pde as solve_pde
    from meshonet.api.grid import tfi as tfi
    from meshonet.api.layout import layout as layout
    from meshonet.api.models import models as models
    from meshonet.api.plot import plot as plot
    from meshonet.api.quality import quality as quality
    from meshonet.api.quality import quality_page as quality_page
    from meshonet.api.stack import read_stack as read_stack
    from meshonet.api.stack import stack as stack
    from meshonet.api.sweep import sweep as sweep
    from meshonet.api.train import train as train
    from meshonet.geometry.aircraft.aircraft import Aircraft as Aircraft
    from meshonet.geometry.aircraft.body import Body as Body
    from meshonet.geometry.aircraft.body_section import BodySection as BodySection
    from meshonet.geometry.aircraft.fin import Fin as Fin
    from meshonet.geometry.aircraft.lofted_body import LoftedBody as LoftedBody
    from meshonet.geometry.blocks.boundary import Boundary as Boundary
    from meshonet.geometry.blocks.grid import Grid as Grid
    from meshonet.geometry.blocks.motion import Motion as Motion
    from meshonet.geometry.blocks.revolve import Revolution as Revolution
    from meshonet.geometry.domain.domain import Domain as Domain
    from meshonet.geometry.errors import InputError as InputError
    from meshonet.geometry.errors import MeshonetError as MeshonetError
    from meshonet.geometry.errors import NoValidGridError as NoValidGridError
    from meshonet.geometry.errors import SolverError as SolverError
    from meshonet.geometry.layout.layout import Layout as Layout
    from meshonet.geometry.quality.report import QualityReport as QualityReport
    from meshonet.geometry.rows.row import Row as Row
    from meshonet.geometry.sections.section import Section as Section
    from meshonet.geometry.sections.stack import Stack as Stack
    from meshonet.geometry.spacing.sampling import Sampling as Sampling
    from meshonet.solvers.aircraft.request import AircraftRequest as AircraftRequest
    from meshonet.solvers.pipeline.make_grid import make_grid as make_grid
    from meshonet.solvers.pipeline.make_grid import make_grids as make_grids
    from meshonet.solvers.pipeline.methods import METHODS as METHODS
    from meshonet.solvers.pipeline.parameters import grid_request as grid_request
    from meshonet.solvers.pipeline.request import GridRequest as GridRequest
    from meshonet.solvers.pipeline.result import Result as Result
    from meshonet.solvers.rows.request import RowRequest as RowRequest
    from meshonet.solvers.stacking.request import StackRequest as StackRequest
    from meshonet.solvers.sweeping.sweep import Sweep as Sweep

__version__ = "0.1.0"

_MODULES = {
    "meshonet.api.convert": ("convert",),
    "meshonet.api.deform": ("deform", "rotation"),
    "meshonet.api.derivatives": ("deform_derivative", "optimum_derivative"),
    "meshonet.api.doctor": ("doctor",),
    "meshonet.api.files": ("inputs", "read", "read_all", "write"),
    "meshonet.api.grid": ("grid", "infer", "sample_boundary", "sample_family", "solve_pde", "tfi"),
    "meshonet.api.layout": ("layout",),
    "meshonet.api.models": ("models",),
    "meshonet.api.plot": ("plot",),
    "meshonet.api.quality": ("quality", "quality_page"),
    "meshonet.api.stack": ("read_stack", "stack"),
    "meshonet.api.sweep": ("sweep",),
    "meshonet.api.train": ("train",),
    "meshonet.geometry.aircraft.aircraft": ("Aircraft",),
    "meshonet.geometry.aircraft.body": ("Body",),
    "meshonet.geometry.aircraft.body_section": ("BodySection",),
    "meshonet.geometry.aircraft.fin": ("Fin",),
    "meshonet.geometry.aircraft.lofted_body": ("LoftedBody",),
    "meshonet.geometry.blocks.boundary": ("Boundary",),
    "meshonet.geometry.blocks.motion": ("Motion",),
    "meshonet.geometry.blocks.grid": ("Grid",),
    "meshonet.geometry.domain.domain": ("Domain",),
    "meshonet.geometry.errors": ("InputError", "MeshonetError", "NoValidGridError", "SolverError"),
    "meshonet.geometry.layout.layout": ("Layout",),
    "meshonet.geometry.quality.report": ("QualityReport",),
    "meshonet.geometry.sections.section": ("Section",),
    "meshonet.geometry.rows.row": ("Row",),
    "meshonet.geometry.sections.stack": ("Stack",),
    "meshonet.geometry.blocks.revolve": ("Revolution",),
    "meshonet.geometry.spacing.sampling": ("Sampling",),
    "meshonet.solvers.aircraft.request": ("AircraftRequest",),
    "meshonet.solvers.pipeline.methods": ("METHODS",),
    "meshonet.solvers.pipeline.make_grid": ("make_grid", "make_grids"),
    "meshonet.solvers.pipeline.parameters": ("grid_request",),
    "meshonet.solvers.pipeline.request": ("GridRequest",),
    "meshonet.solvers.pipeline.result": ("Result",),
    "meshonet.solvers.rows.request": ("RowRequest",),
    "meshonet.solvers.stacking.request": ("StackRequest",),
    "meshonet.solvers.sweeping.sweep": ("Sweep",),
}
__all__ = ["__version__", *chain.from_iterable(_MODULES.values())]


def __getattr__(name: str) -> Any:
    """Return a public name, which is loaded at its first use (PEP 562)."""
    for module, names in _MODULES.items():
        if name in names:
            value = globals()[name] = getattr(import_module(module), name)
            return value
    raise AttributeError(f"module 'meshonet' has no attribute {name!r}")


def _measured(grid: Any) -> Any:
    return import_module("meshonet.geometry.quality.measure").measure(grid, percentiles=True)


ABOVE["measure"] = _measured
ABOVE["write"] = lambda *what, **settings: __getattr__("write")(*what, **settings)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
