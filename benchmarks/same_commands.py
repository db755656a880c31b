"""The commands of `same.py`, one of each kind, in the form of `golden_commands`, and inputs of their own."""

import shutil
import subprocess
import sys
from pathlib import Path

SMALL = """
sample-boundary --family four-sided --count 4 --seed 3 --res 33 --json -> domains.h5
sample-boundary --family procedural --count 3 --seed 7 --res 33x17 --json
sample-boundary --family bodies --count 2 --seed 3 --res 65x33 --json -> bodies.h5
sample-boundary naca:2412 --res 81x31 --spacing curvature --json
tfi duct.csv --res 41x21 --json
solve-pde made/domains.h5 --json
solve-pde made/domains.h5 --method variational --json
solve-pde duct.csv --method steger-sorenson --spacing-south 1e-3 --json
solve-pde channel.csv --res 41x21 --wall-spacing 1e-4 --json
solve-pde tight.csv --json
infer made/domains.h5 --model quad-general --json
infer made/bodies.h5 --model hole-o --json
infer naca:2412 --model airfoil-o --res 65x33 --json
infer naca:2412 --res 65x33 --json -> airfoil.vts
infer naca:0012 --y-plus 1 --reynolds 6e6 --res 81x41 --json
infer blunt.dat --te round --wall-spacing 1e-4 --res 81x41 --topology o --json
infer sharp.dat --wall-spacing 1e-5 --res 121x41 --topology c --json
infer ring.wkt --res 49x17 --json
infer tee.geojson --cells 600 --json
infer tube-bank.geojson --cells 2500 --json
infer channel-cylinder.geojson --first-cell 2e-3 --cells 2500 --json
infer naca:2412 --pitch 0,0.8 --wall-spacing 1e-4 --cells 3000 --json
deform made/airfoil.vts --wall naca:2415 --json
quality made/airfoil.vts --profile openfoam --json
quality folded.h5 --json
convert c.h5 --coarsen 4 --json
convert quad.h5 --extrude 1 --planes 7 --json -> box.h5
solve-pde made/box.h5 --json
stack wing.toml --wall-spacing 1e-3 --around 33 --span 9 --far-field 5 --json -> .cgns
stack examples/blade-row/rotor.toml --cells 20000 --first-cell 3e-3 --growth 1.5 --threads 2 --json -> .cgns
stack examples/aircraft/jet.toml --around 49 --span 5 --first-cell 1e-2 --growth 1.4 --json -> .cgns
sweep circle bend.toml --around 32 --planes 9 --json -> .cgns
"""
LARGE = """
solve-pde bend.csv --res 400 --json
solve-pde duct.csv --res 300 --method variational --coarse off --json
infer example.dat --res 400x200 --json
infer main.dat flap.dat --assemble --y-plus 1 --reynolds 5e6 --cells 9000 --json
infer y-junction.geojson --first-cell 1e-2 --walls outer --cells 6000 --json
stack wing.toml --y-plus 1 --reynolds 1e6 --around 97 --span 25 --json -> .cgns
"""
TUTORIALS = """
infer examples/naca2412.dat --res 200x100 --json -> .vts
infer blade.dat --pitch 0,0.8 --y-plus 1 --reynolds 1e6 --te round --cells 16000 --json -> .cgns
solve-pde channel.geojson --cells 1250 --refine 2 --json -> .vtm
solve-pde channel.geojson --cells 5000 --json -> .vtm
infer naca:0012 --normalise --y-plus 1 --reynolds 6e6 --res 250x110 --far-field 500 --json -> .vts
infer naca:0012-sharp --y-plus 1 --reynolds 6e6 --res 300x100 --constant-layers 2 --json -> .vts
infer main.dat flap.dat --assemble --y-plus 1 --reynolds 5e6 --far-field 50 --cells 30000 --json
sweep circle:0.5 bend.toml --around 32 --planes 41 --json -> .cgns
stack wing.toml --y-plus 30 --reynolds 1e6 --around 65 --span 25 --far-field 10 --json -> .cgns
"""
"""As on the pages of `docs/tutorials`; their inputs are made as there."""

LINES = [line for text in (SMALL, LARGE, TUTORIALS) for line in text.splitlines() if line]
EMULATED = [line for line in SMALL.splitlines() if line]
"""Those that an emulated processor is given: it is some twenty times slower."""
DOMAINS = ("tee", "tube-bank", "channel-cylinder", "y-junction")


def write_more_inputs(folder: Path, root: Path) -> None:
    """Write the domains of the examples and what the tutorials begin with to `folder`."""
    shutil.copytree(root / "examples", folder / "examples", ignore=shutil.ignore_patterns("run-*", "paper"))
    _run([sys.executable, "examples/domains/domains.py", "domains"], folder)
    for name in DOMAINS:
        shutil.copy(folder / "domains" / f"{name}.geojson", folder)
    shutil.copy(folder / "examples" / "pipe-bend-openfoam" / "bend.toml", folder)
    (folder / "channel.geojson").write_text(
        _run([sys.executable, "examples/cylinder-openfoam/channel.py"], folder)
    )
    for page in ("cascade", "multi-element"):
        _run([sys.executable, "-c", program_of(root / f"docs/tutorials/{page}.md")], folder)
    wing = (root / "docs/tutorials/wing.md").read_text().split("```toml\n")[1].split("```")[0]
    (folder / "wing.toml").write_text(wing)


def program_of(page: Path) -> str:
    """Return the program between ``cat > NAME.py <<'END'`` and ``END`` of a page."""
    return page.read_text().split("<<'END'\n")[1].split("\nEND")[0]


def _run(words: list[str], folder: Path) -> str:
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True).stdout
