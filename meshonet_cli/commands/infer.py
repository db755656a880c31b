"""``meshonet infer``."""

from typing import Annotated, Literal

import typer

from meshonet_cli import layers as layer
from meshonet_cli import options as o
from meshonet_cli import walls as wall

EXAMPLES = (
    "meshonet infer airfoil.dat --res 800 -o grid.vts",
    "meshonet infer naca:2412 --fail-on 'max_angle>178' --json -o naca2412.h5",
    "meshonet infer airfoil.dat --wall-spacing 1e-5 --growth 1.15 -o viscous.vts",
    "meshonet infer airfoils/*.dat --res 200 -o 'grids/{stem}.vts'",
)

# fmt: off
ModelName = Annotated[
    str | None,
    typer.Option(
        "--model", metavar="NAME|PATH", show_default=False,
        help="Operator: a shipped one (meshonet models), a .safetensors file, or base for none. C grids are "
        "marched and take none. [default: what measures best for the topology]",
    ),
]
Polish = Annotated[
    str,
    typer.Option(
        "--polish", metavar="auto|off|N",
        help="Steps after the operator: elliptic ones, or of descent. With off or N the network of the "
        "topology answers when no model is named.",
    ),
]
Answer = Annotated[
    Literal["valid", "pasted", "raw"],
    typer.Option(
        "--answer", metavar="valid|pasted|raw",
        help="What becomes of the answer of a model that does not meet the boundary exactly: raw leaves it, "
        "pasted puts the true boundary on its edges, valid unfolds cells after that.",
    ),
]
DeviceName = Annotated[
    Literal["cpu", "cuda"] | None,
    typer.Option(
        "--device", metavar="cpu|cuda", show_default=False,
        help="Compute grids of networks with torch there, members of a batch together: airfoil-o with 3 "
        "steps after it unless told otherwise, others with none. Needs torch. [default: here, without torch]",
    ),
]
# fmt: on


def infer(
    boundary: o.Boundaries,
    output: o.Output,
    res: o.Resolution = None,
    model: ModelName = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: DeviceName = None,
    topology: o.TopologyOption = "auto",
    spacing: o.SpacingOption = "auto",
    le_spacing: o.LeSpacing = None,
    te_spacing: o.TeSpacing = None,
    wall_spacing: layer.WallSpacing = None,
    y_plus: layer.YPlus = None,
    reynolds: layer.Reynolds = None,
    chord_fraction: layer.ChordFraction = 0.5,
    growth: layer.Growth = None,
    constant_layers: wall.ConstantLayers = None,
    te: o.TrailingEdge = "auto",
    far_field: o.FarField = None,
    wake: o.Wake = None,
    wake_nodes: o.WakeNodes = None,
    corners: o.Corners = "auto",
    normalise: o.Normalise = False,
    allow_invalid: o.AllowInvalid = False,
    fail_on: o.FailOn = None,
    from_format: o.From = None,
    to_format: o.To = None,
    skip_existing: o.SkipExisting = False,
    jobs: o.Jobs = 1,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Make grids with a neural operator; with a first cell given, by marching from the wall."""
    from functools import partial

    from meshonet.solvers.neural.inference import infer as operate
    from meshonet.solvers.neural.inference import infer_many, many_of
    from meshonet_cli.batch import Destination
    from meshonet_cli.gates import parse_gates
    from meshonet_cli.gridding import Recipe, make_grids
    from meshonet_cli.session import Session
    from meshonet_cli.together import Together

    layers = layer.read_layers(wall_spacing, y_plus, reynolds, chord_fraction, growth, res)
    unused = {
        "--model": model,
        "--polish": None if polish == "auto" else polish,
        "--answer": None if answer == "valid" else answer,
        "--device": device,
    }
    edges = wall.read_edges((), constant_layers, growth, res, layers)
    steps = o.polish_steps(polish)
    solver = Together(
        partial(operate, model=model, polish=steps, answer=answer, device=device),
        partial(infer_many, model=model, polish=steps, device=device),
        many_of(model, device, steps),
    )
    lengths = {"le_spacing": le_spacing, "te_spacing": te_spacing, "far_field": far_field, "te": te}
    lengths |= {"wake": wake, "wake_nodes": wake_nodes, "viscous": layers is not None}
    recipe = Recipe(
        o.sampling(
            res, topology, layer.spacing_along(layers, spacing), corners, normalise=normalise, **lengths
        ),
        wall.WithWalls("auto", solver, layers, edges, unused),
        allow_invalid,
        parse_gates(fail_on),
        repair=answer == "valid",
        together=solver if solver.topology else None,
    )
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    destination = Destination(output, to_format, "grids")
    return make_grids(
        boundary, recipe, destination, session, fmt=from_format, skip_existing=skip_existing, jobs=jobs
    )
