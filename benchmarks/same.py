"""The same grids on every machine: commands on several, their results beside kept digests.

    python benchmarks/same.py                    what differs from benchmarks/same.json, and where
    python benchmarks/same.py --emulated         on emulated processors too, where qemu-x86_64 is installed
    python benchmarks/same.py --record           keep the digests of this machine, with --only some of them
    python benchmarks/same.py --only 'infer' --machine emulated
    python benchmarks/same.py --small --machine 'this one'     commands of small grids, here: seconds

Kept of each command is one digest: exit code, nodes, counts, figures and messages of its report, times and
versions left out. A machine here is this processor with the kernels of BLAS and the functions of NumPy that
another one would be given, with one core, or another processor that is emulated. The exit code is 1 when a
digest differs.
"""

import argparse
import json
import re
import shutil
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from golden_records import Record, record_of
from golden_runs import TIMED_OUT, Machine, needed, run_all
from golden_shapes import write_inputs
from same_commands import EMULATED, LINES, write_more_inputs

ROOT = Path(__file__).resolve().parents[1]
KEPT = Path(__file__).with_name("same.json")
PROCESSORS = ("Haswell-v4", "EPYC-v3")
EMULATOR = "qemu-x86_64"
SLOWER = 30
"""How many times longer commands take when they are emulated, at the most."""
Digests = dict[str, str]


def main() -> int:
    """Run the commands everywhere, compare or record their digests, and return the exit code."""
    options = _options()
    lines = EMULATED if options.small else LINES
    chosen = [line for line in lines if re.search(options.only, line)]
    kept: Digests = json.loads(KEPT.read_text())
    if options.record:
        made = _digests(chosen, Machine())
        if TIMED_OUT in made.values():
            raise SystemExit("commands took too long: nothing is recorded")
        known = kept | made
        KEPT.write_text(json.dumps({line: known[line] for line in LINES if line in known}, indent=0) + "\n")
        return 0
    wanted = {name: one for name, one in machines(options.emulated).items() if options.machine in name}
    begun, wrong = time.perf_counter(), 0
    with ThreadPoolExecutor(2) as pool:
        lines = {
            name: [line for line in chosen if line in EMULATED or not one.before]
            for name, one in wanted.items()
        }
        made = {name: pool.submit(_digests, lines[name], one) for name, one in wanted.items()}
        for name, job in made.items():
            digests = job.result()
            other = [line for line, digest in digests.items() if digest != kept.get(line)]
            wrong += len(other)
            print(f"{name}: {len(digests) - len(other)} of {len(digests)} commands as kept", flush=True)
            for line in other:
                print(f"  {'TIMED OUT' if digests[line] == TIMED_OUT else 'DIFFERENT'}: {line}")
    print(f"{len(wanted)} machines, {wrong} differences ({time.perf_counter() - begun:.0f} s)")
    return int(wrong > 0)


def machines(emulated: bool = False) -> dict[str, Machine]:
    """Return the machines by name, most other than this one in several ways at once.

    Those of which OpenBLAS has no kernels for this processor are left out.
    """
    features = numpy_features()
    off = {
        "AVX2": " ".join(features),
        "AVX-512": " ".join(name for name in features if "512" in name or name == "X86_V4"),
    }
    two = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "2")
    made = {
        "this one": Machine(),
        "one core, BLAS of Prescott, NumPy without AVX2": Machine(
            settings={"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": off["AVX2"]}, cores=1
        ),
        "BLAS of Haswell, NumPy without AVX-512": Machine(
            settings={"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": off["AVX-512"]}
        ),
        "two threads of BLAS of Zen, memory that is not zero": Machine(
            settings={"OPENBLAS_CORETYPE": "Zen", "MALLOC_PERTURB_": "165", **two}
        ),
    }
    if "AVX512F" in numpy_found():
        made["BLAS of SkylakeX"] = Machine(settings={"OPENBLAS_CORETYPE": "SkylakeX"})
    if emulated and shutil.which(EMULATOR) is None:
        print(f"{EMULATOR} is not installed: no processors are emulated")
    elif emulated:
        # QEMU 7.2 sorts wrongly in NumPy's functions for AVX2; they are compared without it, above
        plain = {"NPY_DISABLE_CPU_FEATURES": " ".join(features)}
        made |= {
            f"emulated {name}": Machine((EMULATOR, "-cpu", name), plain, slower=SLOWER) for name in PROCESSORS
        }
    return made


def numpy_features() -> list[str]:
    """Return the names of the features that NumPy was built to pick functions by."""
    return list(np._core._multiarray_umath.__cpu_dispatch__)


def numpy_found() -> list[str]:
    """Return the names of the features that NumPy knows this processor to have."""
    return [name for name, there in np._core._multiarray_umath.__cpu_features__.items() if there]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", action="store_true", help="keep the digests of this machine")
    parser.add_argument("--emulated", action="store_true", help="with emulated processors")
    parser.add_argument("--small", action="store_true", help="commands of small grids alone")
    parser.add_argument("--only", default="", metavar="REGEX", help="commands in which this is found")
    parser.add_argument("--machine", default="", metavar="NAME", help="machines with this in their name")
    options = parser.parse_args()
    options.emulated |= "emulated" in options.machine
    return options


def _digests(chosen: list[str], machine: Machine) -> Digests:
    """Return the digests of commands by line, run on a machine."""
    with TemporaryDirectory(prefix="same-") as name:
        folder = Path(name)
        write_inputs(folder, ROOT / "examples" / "naca2412.dat")
        write_more_inputs(folder, ROOT)
        return dict(_each(chosen, folder, machine))


def _each(chosen: list[str], folder: Path, machine: Machine) -> Iterator[tuple[str, str]]:
    for line, run in run_all(needed(LINES, chosen), ROOT, folder, len(LINES), machine):
        if line in chosen:
            yield line, TIMED_OUT if run.exit == TIMED_OUT else digest_of(record_of(run, ROOT))


def digest_of(record: Record) -> str:
    """Return the digest of what a command left, its numbers and its words but those of an emulator."""
    words = {
        place: "\n".join(line for line in text.splitlines() if not line.startswith(EMULATOR))
        for place, text in record.words.items()
    }
    text = json.dumps([record.numbers, words], sort_keys=True)
    return sha256(text.encode()).hexdigest()[:16]


if __name__ == "__main__":
    sys.exit(main())
