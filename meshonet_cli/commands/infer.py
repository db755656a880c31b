"""``meshonet infer``."""

from typing import Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet infer airfoil.dat --res 800 -o grid.vts",
    "meshonet infer naca:2412 --fail-on 'max_angle>178' --json -o naca2412.h5",
    "meshonet infer airfoil.dat --first-cell 1e-5 --growth 1.15 -o viscous.vts",
    "meshonet infer airfoils/*.dat --res 200 -o 'grids/{stem}.vts'",
    "meshonet infer airfoils.zip --pick 'naca*' --res 200 -o dataset.h5",
    "meshonet infer plate.geojson --cells 2500 -o plate.cgns",
    "meshonet infer main.dat flap.dat --assemble --far-field 20 -o wing.cgns",
)
_option = o.option_of(o.METHOD)


# fmt: off
def infer(
    boundary: o.Boundaries,
    grids: o.GridOptions,
    sampling: o.SamplingOptions,
    boundary_layer: o.LayerOptions,
    checks: o.CheckOptions,
    domain: o.DomainOptions,
    volume: o.VolumeOptions,
    blocks: o.BlocksName = "auto",
    model: str | None = _option(
        metavar="NAME|PATH", help="Neural operator that makes the grid: a shipped model (meshonet models "
        "lists them), a .safetensors file, or base, the conformal solver without a network. No model makes C "
        "grids. [default: no operator]",
    ),
    polish: str = _option(
        default="auto", metavar="auto|off|N", help="Number of solver iterations after the neural operator. "
        "off: none. auto: as many as suit the model. off or N without --model selects the default model for "
        "the topology.",
    ),
    answer: Literal["valid", "pasted", "raw"] = _option(
        default="valid", help="Treatment of the grid that a network predicts. raw: none; its boundary nodes "
        "can differ from the given ones. pasted: the given boundary nodes replace the predicted ones. valid: "
        "as pasted, and folded cells are repaired.",
    ),
    device: Literal["cpu", "cuda"] | None = _option(
        help="Evaluate networks with torch on this device, all grids of a batch together. --polish auto "
        "then means 3 for airfoil-o and off for other models. [default: NumPy, without torch]",
    ),
    fallback: bool = _option(
        default=False, help="Use the solver that the network imitates if the network's grid has folded "
        "cells or an expected relative L2 error above 0.03.",
    ),
    refine: o.Refine = 0,
) -> int:
    """Make grids by the method that suits the kind of shape.

    O grids are made by a conformal map. C grids are marched. Four-sided grids, and volumes inside six faces,
    are made by the variational method. Other planar domains are split into blocks. If a first-cell height is
    given, O grids and the volume outside a surface are marched from the wall, and four-sided grids are made
    by Winslow's equations. With --model, --polish, --device or --fallback, and for bodies without a suitable
    conformal map, a neural operator makes the grid; the report then gives the expected error.
    """
    from meshonet_cli.tasks.grids import write_grids

    steps = None if polish == "auto" else o.polish_steps(polish)
    settings = {"model": model, "polish": steps, "answer": answer, "device": device}
    settings["fallback"] = fallback or None
    request = grids.request(
        "best", settings, sampling, boundary_layer, checks, volume, refine=refine, blocks=blocks,
        **domain.parameters(),
    )
    batch = grids.batch(grids.inputs(boundary), grids)
    return write_grids(batch, request, grids.criteria(grids.leave_out_failed), assemble=domain.assemble)
# fmt: on
