"""`meshonet.doctor`."""

import platform
import re
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from meshonet.geometry.threads import cores, thread_count

ADDS = {
    "train": "training of models, gradients, GPUs: meshonet train, infer --device",
    "cad": "STEP and B-rep files as surfaces",
    "dxf": "DXF drawings as domains",
    "pyvista": "grid.to_pyvista()",
    "smooth": "smoothing splines through points of airfoils: --smooth",
    "dask": "batches on many machines: --engine dask",
    "mpi": "batches on many machines: --engine mpi",
}
"""Features of the optional extras."""
_FOR_DEVELOPERS = ("test", "lint", "docs")
_LEVELS = (
    ("x86-64-v4", {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}),
    ("x86-64-v3", {"avx2", "bmi2", "fma", "movbe"}),
)
"""Instruction sets for which kernels are compiled, and the processor flags that they require."""
_REQUIREMENT = re.compile(r"([\w.-]+)\s*(?:\[[^]]*\])?\s*([^;]*)(?:;.*extra\s*==\s*['\"]([\w-]+)['\"])?")
_LIMIT = re.compile(r"(>=|<)\s*([\d.]+)")


@dataclass(frozen=True)
class Finding:
    """A result of the examination: group, name and value of a part, whether it works (`well`), and a remedy.

    `well` is None for optional parts that are not installed.
    """

    group: str
    name: str
    value: str
    well: bool | None = True
    remedy: str = ""


def doctor() -> list[Finding]:
    """Examine which parts of the installation exist and work.

    Returns
    -------
    list of Finding
        Group, name and value of each part, whether it works (None: an optional part that is not installed),
        and a remedy.

    Examples
    --------
    >>> [finding.value for finding in doctor() if finding.name == "a grid"][0].startswith("41 x 11 nodes")
    True
    """
    return [*_program(), *_packages(), *_extras()]


def _program() -> Iterator[Finding]:
    from meshonet import __version__
    from meshonet.solvers.neural.registry import shipped

    yield Finding("program", "meshonet", f"{__version__}, in {Path(__file__).parents[1]}")
    yield Finding("program", "python", f"{platform.python_version()}, {sys.executable}")
    yield Finding("program", "system", f"{platform.system()} {platform.machine()}")
    yield Finding("program", "kernels", f"compiled, {instructions()}")
    yield Finding("program", "threads", f"{thread_count()} of {cores()} cores")
    names = shipped()
    remedy = "install meshonet again: files of it are missing"
    yield Finding("program", "models", ", ".join(names) or "none", bool(names), "" if names else remedy)
    yield _grid()


def _grid() -> Finding:
    from meshonet.api.grid import infer

    begun = time.perf_counter()
    try:
        grid = infer("naca:0012", res=(41, 11))
    except Exception as error:  # the report on the installation contains any error
        remedy = "install meshonet again; meshonet infer naca:0012 -o g.vts --debug shows more"
        return Finding("program", "a grid", f"failed: {type(error).__name__}: {error}", False, remedy)
    spent = 1e3 * (time.perf_counter() - begun)
    folded = grid.quality().folded
    return Finding("program", "a grid", f"{grid.ni} x {grid.nj} nodes in {spent:.0f} ms", folded == 0)


def instructions() -> str:
    """Return the instruction set that kernels use on this processor, if the system states it."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return platform.machine() or "of an unknown machine"
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return "x86-64"
    flags = set(next((line for line in text.splitlines() if line.startswith("flags")), "").split())
    return next((name for name, needed in _LEVELS if needed <= flags), "x86-64")


def _packages() -> Iterator[Finding]:
    for name, limits, extra in requirements():
        if not extra:
            yield _package("packages", name, limits, f"pip install '{name}{limits}'")


def _extras() -> Iterator[Finding]:
    extras: dict[str, list[tuple[str, str]]] = {}
    for name, limits, extra in requirements():
        if extra and extra not in _FOR_DEVELOPERS:
            extras.setdefault(extra, []).append((name, limits))
    for extra, needed in extras.items():
        adds, remedy = ADDS.get(extra, "see its page on dependencies"), f"pip install 'meshonet[{extra}]'"
        packages = [_package("extras", name, limits, remedy) for name, limits in needed]
        ill = [each for each in packages if each.well is False and each.value != "not installed"]
        if ill:
            yield Finding("extras", extra, f"{ill[0].name} {ill[0].value}; {adds}", False, remedy)
        elif all(each.well for each in packages):
            versions = ", ".join(f"{each.name} {each.value}" for each in packages)
            yield Finding("extras", extra, f"{versions}; {adds}")
        else:
            yield Finding("extras", extra, f"not installed; {adds}", None, remedy)


def requirements() -> list[tuple[str, str, str]]:
    """Return names, version limits and extras of the dependencies; empty if meshonet is not installed."""
    try:
        lines = metadata.requires("meshonet") or []
    except metadata.PackageNotFoundError:
        return []
    matches = [match.groups() for line in lines if (match := _REQUIREMENT.match(line))]
    return [(name, limits.strip(" ()"), extra or "") for name, limits, extra in matches]


def _package(group: str, name: str, limits: str, remedy: str) -> Finding:
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        return Finding(group, name, "not installed", False, remedy)
    if not within(version, limits):
        return Finding(group, name, f"{version}, and {limits} is needed", False, remedy)
    return Finding(group, name, version)


def within(version: str, limits: str) -> bool:
    """Return whether a version is within lower and upper limits.

    >>> within("0.28.0", ">=0.26,<0.29"), within("0.29", ">=0.26,<0.29"), within("2.13.0+cpu", ">=2.5")
    (True, False, True)
    """
    own = _numbers(version)
    kept = _LIMIT.findall(limits)
    return all((own >= _numbers(limit)) == (compare == ">=") for compare, limit in kept)


def _numbers(version: str) -> tuple[int, ...]:
    """Return the numbers of a version without trailing zeros."""
    numbers = [int(number) for number in re.findall(r"\d+", re.split(r"[+a-zA-Z]", version)[0])]
    while numbers and not numbers[-1]:
        numbers.pop()
    return tuple(numbers)
