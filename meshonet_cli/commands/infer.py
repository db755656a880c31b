"""``meshonet infer``."""

from typing import Annotated, Literal

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
    model: Annotated[str | None, _option(
        "--model", metavar="NAME|PATH",
        help="Neural operator that makes the grid: the name of a shipped model (see meshonet models), a "
        ".safetensors file, or base for the conformal solver without a network. C grids are always marched, "
        "without an operator. [default: no network; the method described above]",
    )] = None,
    polish: Annotated[str, _option(
        "--polish", metavar="auto|off|N", show_default=True,
        help="Number of solver iterations after the neural operator (elliptic around bodies, variational in "
        "four-sided domains); off means no iteration. If --polish is off or N and --model is not given, the "
        "default network for the topology makes the grid.",
    )] = "auto",
    answer: Annotated[Literal["valid", "pasted", "raw"], _option(
        "--answer", metavar="valid|pasted|raw", show_default=True,
        help="Treatment of the grid that a network predicts, whose boundary nodes can differ from the given "
        "ones. raw writes this grid, pasted replaces its boundary nodes by the given nodes, and valid also "
        "repairs folded cells.",
    )] = "valid",
    device: Annotated[Literal["cpu", "cuda"] | None, _option(
        "--device", metavar="cpu|cuda",
        help="Evaluate networks with torch on this device, all grids of a batch together. --polish auto is "
        "then 3 iterations for airfoil-o and no iteration for other models. [default: NumPy, without torch]",
    )] = None,
    fallback: Annotated[bool, _option(
        "--fallback",
        help="Make the grid by the solver that the network imitates if the expected error of the network is "
        "above 0.03 or its grid has folded cells.",
    )] = False,
    refine: o.Refine = 0,
) -> int:
    """Make grids by the method that suits the kind of shape.

    The method is the one with the best results in benchmarks for this kind of shape. An O grid around a body
    is made by a conformal map. A C grid, or a grid with a first cell, is marched from the wall. A four-sided
    domain is filled by the variational method. Any other planar domain is split into blocks. A volume inside
    six faces is filled by the variational method. With a first cell, the volume outside a surface is marched
    from the surface. A neural operator makes the grid only if --model, --polish, --device or --fallback is
    given; the report then gives the expected error of the grid.
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
