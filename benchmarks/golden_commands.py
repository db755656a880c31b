"""The golden commands: methods, topologies, sizes, layers and formats, one line each.

A line is a command as a user types it, without ``-o``. Behind ``->`` stands the output's ending (``.h5`` when
there is none), its name when later commands read it as ``made/NAME``, or ``-`` for standard output. Behind
``<`` stands a file for standard input. `quality`, `models`, and what ends in ``-> no`` have no output.

    solve-pde duct.csv --method winslow -> .vts
    tfi duct.csv --res 41x21 -> start.h5
    solve-pde duct.csv --res 41x21 --initial made/start.h5
"""

from collections.abc import Iterable
from itertools import product

from meshonet.formats.table import TABLE
from meshonet.geometry.families.draw import RANDOM
from meshonet.geometry.families.family import FAMILIES
from meshonet.geometry.quality.profiles import PROFILES
from meshonet.geometry.spacing.laws import LAWS
from meshonet.solvers.pipeline.methods import METHODS

# of the tables of this checkout, so that what is added to one is compared too
FORMATS = [
    row for row in TABLE.values() if row.write_grids and row.name not in ("png", "svg", "pdf", "html", "hdf5")
]
ENDINGS = [ending for row in FORMATS for ending in row.suffixes]
WORDS = [(row, word) for row in FORMATS for words in row.choices for word in words]
VARIANTS = [f"{row.suffixes[0]} --to {row.name}:{word}" for row, word in WORDS]
EXTRUDED = [row.suffixes[0] for row in FORMATS if "volumes" in row.space]
SOLVERS = [name for name, row in METHODS.items() if row.solves]
ALGEBRAIC = [name for name, row in METHODS.items() if row.algebraic]
AIRFOILS = "naca:0012 naca:23112 naca:4415 sharp.dat"

BOUNDARIES = """
sample-boundary naca:2412 --json
sample-boundary naca:23012 --res 101x31 --normalise
sample-boundary naca:0012-sharp --topology c --res 121x31 --wake 6 --wake-nodes 25
sample-boundary example.dat --topology c --res 121x31 --te exact
sample-boundary blunt.dat --res 121x31 --te round
sample-boundary blunt.dat --res 121x31 --te wedge
sample-boundary sharp.dat --res 81x31 --le-spacing 0.002 --te-spacing 0.001 --far-field 30
sample-boundary lednicer.dat --res 81x31 --topology o --json
sample-boundary ellipse.csv --res 65x33 --json
sample-boundary ellipse.csv --res 33 --topology quad
sample-boundary outline.csv --res 33 --corners 0,12,24,36
sample-boundary square.csv --res 17x9
sample-boundary channel.csv --res 41x21 --json
sample-boundary duct.csv --sensors 20 --json
sample-boundary two.wkt two.geojson --res 33 --json
sample-boundary ring.wkt --res 49x17 --json
sample-boundary quad.h5 o.h5 -> {stem}.h5
sample-boundary naca:0012 --res 61x21 --json -> b.h5
sample-boundary --family hexagon --count 12 --seed 1 --res 17 --split random --json -> hexagons.h5
sample-boundary --family wrench --range 0.2:0.3 --count 2 --seed 5 --res 33 --json
sample-boundary --family four-sided --count 6 --seed 3 --res 33 -> domains.h5
sample-boundary --family bodies --count 4 --seed 3 --res 65x33 -> bodies.h5
sample-boundary naca:0012 --res 61x21 -> -
"""
INTERPOLATED = """
tfi duct.csv --res 81x41 -> start.h5
tfi naca:2412 --res 101x41 -> start-o.h5
tfi made/domains.h5 --allow-invalid --json
tfi tight.csv --json
tfi tight.csv --repair --json
tfi tight.csv --allow-invalid --json
tfi example.dat --topology c --res 121x31 --allow-invalid --json
tfi duct.csv --res 81x41 --spacing-south 1e-3 --growth 1.5 --json
tfi flat.csv --res 41 --wall-spacing 1e-3 --constant-layers 3 --json
tfi duct.csv --res 41x21 --fail-on max_angle>95 --fail-on skewness.p99>0.5 --json -> .p3d
tfi square.csv --res 2x2 --json
tfi < made/b.h5 - -> -
"""
SOLVED = """
solve-pde duct.csv --res 201 --coarse 33 --json
solve-pde naca:2412 --res 201x101 --coarse 65 --json
solve-pde bend.csv --res 161 --method variational --coarse 33 --json
solve-pde example.dat --topology c --res 201x61 --method variational --coarse 65 --json
solve-pde bend.csv --res 525 --json
solve-pde duct.csv --res 265 --method variational --json
solve-pde duct.csv --res 265 --method variational --coarse off --json
solve-pde duct.csv --res 25x13 --refine 3 --json
solve-pde naca:2412 --res 51x21 --refine 2 --json
solve-pde bend.csv --res 25x13 --method variational --refine 2 --json
solve-pde example.dat --topology c --res 81x21 --method winslow --refine 1 --json
solve-pde duct.csv --res 81x41 --initial made/start.h5 --json
solve-pde duct.csv --res 81x41 --method variational --initial made/start.h5 --json
solve-pde naca:2412 --res 101x41 --initial made/start-o.h5 --max-cycles 4 --json
solve-pde duct.csv --tol 1e-4 --json
solve-pde duct.csv --tol 1e-11 --history out/cycles.csv --json
solve-pde naca:2412 --res 101x41 --tol 1e-9 --json
solve-pde naca:2412 --res 101x41 --max-cycles 2 --json
solve-pde bend.csv --method variational --tol 1e-8 --max-cycles 20 --history out/cycles.csv --json
solve-pde tight.csv --json
solve-pde tight.csv --no-repair --json
solve-pde tight.csv --no-repair --allow-invalid --json
solve-pde tight.csv --repair-margin 12 --json
solve-pde tight.csv --method variational --json
solve-pde tight.csv --method thomas-middlecoff --json
solve-pde hexagon.csv --res 97x33 --json
solve-pde hexagon.csv --topology o --res 97x33 --json
solve-pde hexagon.csv --topology o --res 97x33 --method variational --json
solve-pde ring.wkt --res 97x33 --json
solve-pde ring.geojson --res 65x33 --method variational --json
solve-pde two.wkt --res 33 --json
solve-pde two.geojson --res 33x65 --spacing tanh --json -> {name}.vts
solve-pde outline.csv --res 49x33 --corners 36,0,12,24 --json
solve-pde quad.h5 o.h5 c.h5 --json -> {stem}.h5
solve-pde made/hexagons.h5 --json -> hexgrids.h5
solve-pde blunt.dat --te round --res 121x41 --json
solve-pde blunt.dat --te wedge --res 121x41 --json
solve-pde square.csv --res 9x5 --json
solve-pde made/domains.h5 --jobs 2 --json
solve-pde naca:2412 --res 61x31 -> -
solve-pde naca:2412 --res 61x31 -> .vts
solve-pde duct.csv --fail-on max_angle>60 --fail-on folded>0
"""
LAYERS = """
solve-pde duct.csv --wall-spacing 1e-3 --json
solve-pde channel.csv --res 81x41 --wall-spacing 1e-4 --json
solve-pde channel.csv --res 81x41 --wall-spacing 1e-4 --no-slide --json
solve-pde duct.csv --wall-spacing 1e-3 --slide --json
solve-pde channel.csv --res 81x61 --wall-spacing 1e-5 --growth 1.4 --json
solve-pde flat.csv --wall-spacing 1e-3 --growth 1.2 --json
solve-pde duct.csv --spacing-south 1e-3 --constant-layers 4 --json
solve-pde duct.csv --spacing-north 2e-3 --spacing-south 1e-3 --json
solve-pde duct.csv --spacing-west 5e-3 --spacing-east 1e-2 --json
solve-pde bend.csv --res 65x41 --spacing-south 1e-3 --growth 1.5 --json
solve-pde channel.csv --res 81x61 --y-plus 1 --reynolds 1e5 --json
solve-pde bend.csv --res 65x33 --wall-spacing 2e-3 --slide --json
solve-pde duct.csv --method steger-sorenson --spacing-south 1e-3 --json
solve-pde duct.csv --method steger-sorenson --wall-angle 75 --json
solve-pde duct.csv --method thomas-middlecoff --spacing-south 5e-3 --json
solve-pde channel.csv --res 65x33 --method thomas-middlecoff --spacing tanh --json
solve-pde duct.csv --method variational --wall-spacing 2e-3 --json
solve-pde duct.csv --res 161x81 --coarse 41 --spacing-south 1e-3 --json
solve-pde naca:2412 --res 101x41 --method steger-sorenson --wall-angle 90 --wall-spacing 1e-3 --json
solve-pde made/domains.h5 --spacing-south 1e-2 --allow-invalid --json
"""
MARCHED = """
infer naca:0012 --y-plus 1 --reynolds 6e6 --res 161x61 --json
infer sharp.dat --y-plus 30 --reynolds 1e6 --chord-fraction 0.2 --res 121x41 --json
infer naca:2412 --wall-spacing 1e-4 --growth 1.15 --json
infer naca:2412 --wall-spacing 1e-4 --growth 1.2 --constant-layers 5 --json
infer blunt.dat --te round --wall-spacing 1e-4 --res 161x61 --json
infer blunt.dat --te wedge --topology o --wall-spacing 1e-4 --res 161x61 --json
infer sharp.dat --wall-spacing 1e-5 --far-field 40 --wake 20 --wake-nodes 41 --res 201x61 --json
infer sharp.dat --wall-spacing 1e-5 --le-spacing 1e-3 --te-spacing 5e-4 --res 201x61 --json
solve-pde naca:2412 --wall-spacing 1e-4 --res 121x41 --json
solve-pde ellipse.csv --wall-spacing 1e-3 --res 81x41 --json
solve-pde hexagon.csv --topology o --wall-spacing 1e-3 --res 97x41 --json
solve-pde naca:4412 --topology c --res 161x41 --json
solve-pde sharp.dat --method hyperbolic --wall-spacing 1e-4 --topology c --res 161x41 --json
solve-pde ring.wkt --wall-spacing 1e-2 --res 97x33 --json
tfi naca:2412 --wall-spacing 1e-3 --res 101x41 --json
solve-pde made/bodies.h5 --wall-spacing 1e-2 --allow-invalid --json
infer o.h5 --wall-spacing 5e-3 --json
"""
OPERATORS = """
infer naca:2412 --json
infer example.dat --res 400x200 --json
infer naca:23012 --res 121x61 --far-field 5 --json
infer duct.csv --json
infer bend.csv --res 201x101 --json
infer tight.csv --json
infer hexagon.csv --topology o --res 97x33 --json
infer ellipse.csv --res 81x41 --json
infer square.csv --res 33 --json
infer blunt.dat --res 121x61 --te exact --json
infer blunt.dat --res 121x61 --te wedge --json
infer sharp.dat --topology c --res 161x41 --json
infer naca:2412 --res 121x61 --spacing uniform --json
infer naca:0012 --res 121x61 --le-spacing 1e-3 --te-spacing 2e-3 --json
infer made/domains.h5 --json
infer made/bodies.h5 --json
infer quad.h5 o.h5 c.h5 --json -> {stem}.h5
infer two.wkt --res 33x17 --json
infer duct.csv --wall-spacing 1e-3 --json
infer naca:2412 --res 11x5 --json
infer naca:2412 --res 61x31 --fail-on max_angle>100 --json
infer duct.csv bend.csv square.csv --res 33 --json -> .h5
infer naca:2412 --res 121x61 --normalise --json -> .cgns
infer made/domains.h5 --model quad-general --device cpu --json
infer naca:2412 naca:0012 --res 65 --device cpu --json
"""
QUALITY = """
quality quad.h5 --json
quality folded.h5 --json
quality o.h5 --json
quality c.h5 --json
quality quad.h5
quality folded.h5
quality folded.h5 --profile openfoam --json
quality o.h5 --profile verdict
quality quad.h5 --per-cell out/cells.vts --json
quality folded.h5 --per-cell out/cells.vts
quality quad.h5 --compare other.h5 --json
quality quad.h5 --compare other.h5
quality quad.h5 other.h5 --compare quad.h5 --summary --fail-on relative_l2>0.01 --json
quality quad.h5 folded.h5 o.h5 c.h5 --summary --json
quality quad.h5 o.h5 --summary
quality folded.h5 --fail-on folded>0 --fail-on max_angle>170 --json
quality < o.h5 - --json
quality quad.h5 --compare o.h5 --json
"""
CONVERTED = """
convert quad.h5 --extrude 1 --planes 4 -> .p3d
convert quad.h5 --extrude 1 --planes 4 -> .cgns
convert quad.h5 --swap --json
convert quad.h5 --normalise --json
convert o.h5 --normalise --json
convert quad.h5 --coarsen 2 --json
convert c.h5 --coarsen 4 --json
convert o.h5 --coarsen 3 --json
convert o.h5 --swap
convert quad.h5 o.h5 c.h5 --json -> .vtm
convert quad.h5 o.h5 -> .cgns
convert quad.h5 o.h5 -> {stem}.p3d
convert quad.h5 --plot3d fortran,big,single -> .p3d
convert quad.h5 --plot3d binary,multi,3d,iblank -> .p3d
convert quad.h5 --plot3d ascii,float32 -> .p3d
convert naca:2412 --json -> .h5
convert duct.csv --json
convert --list-formats -> no
convert --list-formats --json -> no
"""
REFUSED = """
infer missing.dat
infer prose.dat
solve-pde crossed.csv --json
solve-pde nan.csv
tfi open.csv
tfi empty.csv
tfi duct.csv --res 0
tfi duct.csv --res ten
infer naca:24
infer naca:2412 --model no
infer duct.csv --model airfoil-o
solve-pde duct.csv --method hyperbolic
solve-pde duct.csv --tol 2
solve-pde naca:2412 --spacing-south 1e-3
solve-pde duct.csv --growth 1.2
solve-pde duct.csv --wall-angle 80
solve-pde duct.csv --refine 1 --spacing-south 1e-3
infer naca:2412 --y-plus 1
convert quad.h5 --coarsen 5
convert quad.h5 -> .nothing
convert quad.h5 --planes 3 -> .p3d
convert o.h5 --extrude 1 -> .geo
quality duct.csv
solve-pde outline.csv --normalise
quality quad.h5 --fail-on nonsense>1
solve-pde duct.csv --no-such-option
sample-boundary --family no-such-family
sample-boundary duct.csv --sensors 5 -> .vts
no-such-command -> no
solve-pde duct.csv missing.csv bend.csv --res 33 --json
infer duct.csv bend.csv -> .vts
"""
"""Commands that end in an error, whose exit codes are to stay."""


def commands() -> list[str]:
    """Return every line; each of them is there once."""
    lines = [*_boundaries(), *_interpolated(), *_solved(), *_layers(), *_operators(), *_trained()]
    lines += [*_quality(), *_converted(), *_read_again(), *REFUSED.splitlines()]
    return list(dict.fromkeys(" ".join(line.split()) for line in lines if line))


def _boundaries() -> list[str]:
    return [
        *(
            f"sample-boundary --family {name} --count 3 --seed 7 --res 33x17 --json"
            for name in (*FAMILIES, *RANDOM)
        ),
        *(f"sample-boundary naca:2412 --res 81x31 --spacing {law}" for law in LAWS),
        *BOUNDARIES.splitlines(),
    ]


def _interpolated() -> list[str]:
    sources = ("duct.csv", "bend.csv", "channel.csv --res 65x33", "naca:2412 --res 81x31", "c.h5")
    both = product(sources, ("arclength", "linear"))
    methods = product(sources, ALGEBRAIC)
    return [
        *_each("tfi {} --blending {} --json", both),
        *_each("tfi {} --method {} --json", methods),
        *INTERPOLATED.splitlines(),
    ]


def _solved() -> list[str]:
    sources = (
        "duct.csv",
        "bend.csv --res 65x33",
        "naca:2412 --res 101x41",
        "ellipse.csv --res 81x31",
        "example.dat --topology c --res 121x31",
        "made/domains.h5",
        "made/bodies.h5",
    )
    return [
        *_each("solve-pde {} --method {} --json", product(sources, SOLVERS)),
        *(f"solve-pde {airfoil} --res 121x61 --json" for airfoil in AIRFOILS.split()),
        *SOLVED.splitlines(),
    ]


def _layers() -> list[str]:
    airfoils = product(("naca:0012-sharp", "naca:2412", "example.dat", "blunt.dat"), "oc")
    marched = _each("infer {} --wall-spacing 1e-5 --res 161x61 --topology {} --json", airfoils)
    return [*LAYERS.splitlines(), *marched, *MARCHED.splitlines()]


def _operators() -> list[str]:
    hexagon = "hexagon.csv --topology o --res 97x33"
    shipped = {
        "airfoil-o": (
            "naca:2412 --res 121x61",
            "sharp.dat --res 161x41",
            "blunt.dat --te round --res 121x61",
        ),
        "hole-o": (hexagon, "ring.wkt --res 97x33", "made/bodies.h5"),
        "hole-winslow": (hexagon, "made/bodies.h5"),
        "quad-general": ("duct.csv", "bend.csv --res 97x65", "made/domains.h5"),
        "quad-winslow": ("duct.csv", "made/domains.h5"),
        "base": ("naca:2412 --res 121x61", "duct.csv"),
    }
    models = [(source, model) for model, sources in shipped.items() for source in sources]
    polished = product(("naca:2412 --res 121x61", "duct.csv", hexagon), ("off", "2", "20"))
    return [
        *_each("infer {} --model {} --json", models),
        *_each("infer {} --polish {} --json", polished),
        *OPERATORS.splitlines(),
    ]


def _trained() -> list[str]:
    """Return small models of the paper, and what they answer."""
    names = ("meshonet", "pod-deeponet", "fno1d")
    train = "train made/hexgrids.h5 --model {0} --epochs 10 --seed 4 --json -> {0}.safetensors"
    infer = "infer made/hexagons.h5#test --model made/{}.safetensors --answer {} --allow-invalid --json"
    answers = _each(infer, product(names, ("raw", "pasted", "valid")))
    printing = ["models --json", "--version -> no", "--help -> no", "solve-pde --help -> no"]
    return [*(train.format(name) for name in names), *answers, *printing]


def _quality() -> list[str]:
    profiles = product(("quad.h5", "c.h5"), PROFILES)
    return [*_each("quality {} --profile {} --json", profiles), *QUALITY.splitlines()]


def _converted() -> list[str]:
    wakes = (".vts", ".cgns", ".msh --to gmsh-ascii", ".su2", ".foam", ".nmf")
    return [
        *_each("convert {}.h5 -> {}", product(("quad", "o"), (*ENDINGS, *VARIANTS))),
        *(f"convert c.h5 -> {ending}" for ending in wakes),
        *(f"convert o.h5 --extrude 0.1 -> {ending}" for ending in EXTRUDED),
        *CONVERTED.splitlines(),
    ]


def _read_again() -> list[str]:
    """Return files written in a format and read again, as a grid or as a boundary."""
    grids = [".vts", ".vtm", ".vtk", ".vtk --to vtk-ascii", ".cgns", ".p3d", ".bin"]
    meshes = [".msh", ".msh --to gmsh-ascii", ".msh --to gmsh41", ".su2"]
    lines = []
    for topology, (k, form) in product(("quad", "o", "c"), enumerate(grids)):
        ending, _, to = form.partition(" ")
        lines += [
            f"convert {topology}.h5 {to} -> {topology}{k}{ending}",
            f"convert made/{topology}{k}{ending} --json",
        ]
    for topology, (k, form) in product(("quad", "o"), enumerate(meshes)):
        ending, _, to = form.partition(" ")
        name = f"{topology}-mesh{k}{ending}"
        lines += [f"convert {topology}.h5 {to} -> {name}", f"tfi made/{name} --allow-invalid --json"]
    return [*lines, "solve-pde blob.dxf --res 33 --json", "solve-pde made/o-mesh3.su2 --json"]


def _each(line: str, words: Iterable[tuple[str, str]]) -> list[str]:
    """Return `line` with each pair of words in its two places."""
    return [line.format(*pair) for pair in words]
