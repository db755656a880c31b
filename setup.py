"""Build of the compiled kernels: every ``_name.pyx`` is one, with ``name_kernel.c`` where that exists."""

import os
import sys
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

# Contracted, reassociated arithmetic for speed; infinities and NaN keep their meaning so that a diverging
# iteration can be seen. No -march: include/clones.h picks the instruction set when the module is loaded.
FLAGS = (
    []
    if sys.platform == "win32"
    else [
        "-O3",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-fassociative-math",
        "-fno-signed-zeros",
        "-freciprocal-math",
        "-ffp-contract=fast",
    ]
)


def extension(pyx: Path) -> Extension:
    """Return the extension module of one Cython file."""
    kernel = pyx.with_name(pyx.stem.removeprefix("_") + "_kernel.c")
    sources = [str(pyx), *([str(kernel)] if kernel.exists() else [])]
    name = ".".join(pyx.with_suffix("").parts)
    folders = ["include", str(pyx.parent)]
    headers = [str(header) for folder in folders for header in sorted(Path(folder).glob("*.h"))]
    return Extension(
        name, sources, include_dirs=folders, extra_compile_args=FLAGS, libraries=["m"], depends=headers
    )


ROOMS = ("formats", "geometry", "solvers")
MODULES = [extension(pyx) for room in ROOMS for pyx in sorted(Path(room).rglob("_*.pyx"))]
setup(
    ext_modules=cythonize(
        MODULES,
        language_level=3,
        compiler_directives={"boundscheck": False, "wraparound": False, "cdivision": True},
    ),
    options={"build_ext": {"parallel": os.cpu_count() or 1}},
)
