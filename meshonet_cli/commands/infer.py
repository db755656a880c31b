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
    domain: o.DomainOptions,
    volume: o.VolumeOptions,
    blocks: o.BlocksName = "auto",
    model: Annotated[str | None, _option(
        "--model", metavar="NAME|PATH",
        help="Operator: a shipped one (see meshonet models), a .safetensors file, or base for the conformal "
        "solver without a network. C grids are marched and take none. [default: what measures best for the "
        "topology]",
    )] = None,
    polish: Annotated[str, _option(
        "--polish", metavar="auto|off|N", show_default=True,
        help="Iterations of a solver after the operator, elliptic or variational. With off or N and no "
        "--model, the network for the topology is used.",
    )] = "auto",
    answer: Annotated[Literal["valid", "pasted", "raw"], _option(
        "--answer", metavar="valid|pasted|raw", show_default=True,
        help="For models that do not meet the boundary exactly: raw is the output of the network, pasted has "
        "the true boundary on its edges, valid is pasted and unfolded.",
    )] = "valid",
    device: Annotated[Literal["cpu", "cuda"] | None, _option(
        "--device", metavar="cpu|cuda",
        help="Evaluate networks with torch on this device, all grids of a batch together. Without --polish, "
        "airfoil-o then takes 3 steps of polish and other models none. [default: without torch]",
    )] = None,
    refine: o.Refine = 0,
) -> int:
    """Make the grid that measures best: conformal, marched or variational.

    Around a body, this is an O grid by a conformal map, or a grid marched from the wall for C grids and where
    a first cell is given. In a four-sided domain the variational method makes it. Any other domain is split
    into blocks. In space, six faces are filled by the variational method, and volumes are marched from
    surfaces if a first cell is given. A neural operator is used where --model, --polish or --device asks for
    one.
    """
    from meshonet_cli.tasks.grids import write_grids

    settings = {"model": model, "polish": o.polish_steps(polish), "answer": answer, "device": device}
    request = grids.request("best", settings, volume, refine=refine, blocks=blocks, **domain.parameters())
    batch = grids.batch(grids.inputs(boundary), grids)
    return write_grids(batch, request, grids.criteria(), assemble=domain.assemble)
# fmt: on
