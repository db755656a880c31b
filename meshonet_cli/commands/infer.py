"""``meshonet infer``."""

from typing import Annotated, Literal

from meshonet_cli import layers as layer
from meshonet_cli import options as o
from meshonet_cli import walls as wall

EXAMPLES = (
    "meshonet infer airfoil.dat --res 800 -o grid.vts",
    "meshonet infer naca:2412 --fail-on 'max_angle>178' --json -o naca2412.h5",
    "meshonet infer airfoil.dat --first-cell 1e-5 --growth 1.15 -o viscous.vts",
    "meshonet infer airfoils/*.dat --res 200 -o 'grids/{stem}.vts'",
)
_option = o.option_of(o.METHOD)

# fmt: off
ModelName = Annotated[
    str | None,
    _option(
        "--model", metavar="NAME|PATH",
        help="Operator: a shipped one (see meshonet models), a .safetensors file, or base for none. C grids "
        "are marched and take none. [default: what measures best for the topology]",
    ),
]
Polish = Annotated[
    str,
    _option(
        "--polish", metavar="auto|off|N", show_default=True,
        help="Steps after the operator, elliptic or of descent. With off or N the network of the topology "
        "is used when no model is named.",
    ),
]
Answer = Annotated[
    Literal["valid", "pasted", "raw"],
    _option(
        "--answer", metavar="valid|pasted|raw", show_default=True,
        help="For models that do not meet the boundary exactly: raw is the output of the network, pasted has "
        "the true boundary on its edges, valid is pasted and unfolded.",
    ),
]
DeviceName = Annotated[
    Literal["cpu", "cuda"] | None,
    _option(
        "--device", metavar="cpu|cuda",
        help="Evaluate networks with torch there, grids of a batch together; without --polish, airfoil-o "
        "takes 3 steps and others none. [default: without torch]",
    ),
]
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
    from functools import partial

    from meshonet.geometry.errors import InputError
    from meshonet.solvers.neural.inference import infer as operate
    from meshonet.solvers.neural.inference import infer_many, many_of
    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, make_grids
    from meshonet_cli.together import Together

    if checks.repair and answer == "raw":
        raise InputError("{repair} would change a raw answer", "leave one of {repair} and {answer} out")
    layers = layer.read_layers(first, sampling.res)
    unused = {
        "--model": model,
        "--polish": None if polish == "auto" else polish,
        "--answer": None if answer == "valid" else answer,
        "--device": device,
    }
    edges = wall.read_edges(None, first, sampling.res, layers)
    steps = o.polish_steps(polish)
    solver = Together(
        partial(operate, model=model, polish=steps, answer=answer, device=device),
        partial(infer_many, model=model, polish=steps, device=device),
        many_of(model, device, steps),
    )
    recipe = Recipe(
        sampling.settings(spacing=layer.spacing_along(layers, sampling.spacing), viscous=layers is not None),
        wall.WithWalls("auto", solver, layers, edges, unused),
        checks.allow_invalid,
        parse_gates(checks.fail_on),
        repair=answer == "valid" if checks.repair is None else checks.repair,
        together=solver if solver.topology else None,
    )
    destination = Destination(output, files.to_format, "grids")
    return make_grids(
        boundary, recipe, destination, printing.session(),
        fmt=files.from_format, skip_existing=files.skip_existing, jobs=jobs,
    )  # fmt: skip
