"""``meshonet infer``."""

from typing import Annotated, Literal

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet infer airfoil.dat --res 800 -o grid.vts",
    "meshonet infer naca:2412 --fail-on 'max_angle>178' --json -o naca2412.h5",
    "meshonet infer airfoil.dat --first-cell 1e-5 --growth 1.15 -o viscous.vts",
    "meshonet infer airfoils/*.dat --res 200 -o 'grids/{stem}.vts'",
)
_option = o.option_of(o.METHOD)

# fmt: off
ModelName = Annotated[str | None, _option(
    "--model", metavar="NAME|PATH",
    help="Operator: a shipped one (see meshonet models), a .safetensors file, or base for none. C grids are "
    "marched and take none. [default: what measures best for the topology]",
)]
Polish = Annotated[str, _option(
    "--polish", metavar="auto|off|N", show_default=True,
    help="Steps after the operator, elliptic or of descent. With off or N the network of the topology is "
    "used when no model is named.",
)]
Answer = Annotated[Literal["valid", "pasted", "raw"], _option(
    "--answer", metavar="valid|pasted|raw", show_default=True,
    help="For models that do not meet the boundary exactly: raw is the output of the network, pasted has "
    "the true boundary on its edges, valid is pasted and unfolded.",
)]
DeviceName = Annotated[Literal["cpu", "cuda"] | None, _option(
    "--device", metavar="cpu|cuda",
    help="Evaluate networks with torch there, grids of a batch together; without --polish, airfoil-o takes "
    "3 steps and others none. [default: without torch]",
)]
# fmt: on


@o.expanded
def infer(
    boundary: o.Boundaries,
    output: o.Output,
    sampling: o.SamplingOptions,
    first: o.LayerOptions,
    checks: o.CheckOptions,
    files: o.FileOptions,
    printing: o.PrintOptions,
    model: ModelName = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: DeviceName = None,
    jobs: o.Jobs = 1,
) -> int:
    """Make the grid that measures best: conformal, marched or variational.

    Around a body that is an O grid by a conformal map; with a first cell given, and for C grids, a grid
    marched from the wall; in a four-sided domain the variational method. A neural operator is used where
    --model, --polish or --device asks for one.
    """
    from meshonet_cli.grid_batch import request_of, write_grids

    settings = {"model": model, "polish": o.polish_steps(polish), "answer": answer, "device": device}
    request = request_of("best", sampling, checks, first, settings=settings)
    return write_grids(boundary, output, request, checks, files, printing.session(), jobs=jobs)
