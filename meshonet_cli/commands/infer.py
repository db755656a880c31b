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
        metavar="NAME|PATH", help="Neural operator that makes the grid: the name of a shipped model (see "
        "meshonet models), a .safetensors file, or base for the conformal solver without a network. Not for "
        "C grids, which are always marched. [default: no operator; the method described above]",
    ),
    polish: str = _option(
        default="auto", metavar="auto|off|N", help="Number of solver iterations after the neural operator: "
        "elliptic around bodies, variational in four-sided domains. off: none. auto: as many as suit the "
        "model. Without --model, off or N selects the default model for the topology.",
    ),
    answer: Literal["valid", "pasted", "raw"] = _option(
        default="valid", help="Treatment of the grid that a network predicts. raw: unchanged; its boundary "
        "nodes can differ from the given ones. pasted: with the given boundary nodes. valid: as pasted, with "
        "folded cells repaired.",
    ),
    device: Literal["cpu", "cuda"] | None = _option(
        help="Evaluate networks with torch on this device, all grids of a batch together. --polish auto "
        "then means 3 for airfoil-o and off for other models. [default: NumPy, without torch]",
    ),
    fallback: bool = _option(
        default=False, help="Use the solver that the network imitates if the expected error of the network "
        "is above 0.03 or its grid has folded cells.",
    ),
    refine: o.Refine = 0,
) -> int:
    """Make grids by the method that suits the kind of shape.

    The default method is the best in benchmarks for the kind of shape. O grids around bodies are made by a
    conformal map, or with a first cell by marching from the wall. C grids are marched from the wall.
    Four-sided domains are filled by the variational method, or with a first cell by Winslow's equations. All
    other planar domains are split into blocks. Volumes inside six faces are filled by the variational method.
    With a first cell, the volume outside a surface is marched from it. A neural operator makes the grid only
    if --model, --polish, --device or --fallback is given; the report then gives the expected error.
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
