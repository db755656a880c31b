"""Where the packages are, and the build of the kernels.

All C below ``kernels`` is bound by one extension, ``meshonet.kernels._native``.
"""

import os
import shlex
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext

# Imported as meshonet.geometry and so on. The links in meshonet/ are for checkers and editors alone: archives
# and clones may have small text files in their place.
ROOMS = ("geometry", "solvers", "formats", "kernels")
OF_ROOMS = [f"meshonet.{name}" for room in ROOMS for name in find_packages(include=[room, f"{room}.*"])]

ROOM = Path("kernels")
FOLDERS = [str(ROOM / "include"), str(ROOM)]
KERNELS = sorted(str(path) for path in ROOM.glob("*/*.c"))
HEADERS = sorted(str(path) for end in ("h", "pxi", "pyx") for path in ROOM.rglob(f"*.{end}"))
WINDOWS = sys.platform == "win32"
DEBUGGED = "-g" in shlex.split(os.environ.get("CFLAGS", ""))  # by a debugger or sanitizer, which names places
PLAIN = [] if DEBUGGED else ["-g0"]

# The same bits on every processor: operations and sums in the order in which they are written, products and
# sums not contracted. No -march: include/clones.h picks the instruction set when the module is loaded.
NUMERICS = (
    ["/O2"] if WINDOWS else ["-O3", *PLAIN, "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"]
)
GLUE = [] if WINDOWS else ["-O0", *PLAIN]  # checks and calls: nothing to gain
LINK = ["-Wl,-s"] if sys.platform == "linux" and not DEBUGGED else []  # no symbols but what is looked up


class BuildKernels(build_ext):
    """Compiles each kernel with flags of its own, several at a time, before the extension of all."""

    def build_extension(self, ext: Extension) -> None:
        """Compile the kernels, then what binds them."""
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            ext.extra_objects = list(chain.from_iterable(pool.map(self._compile, KERNELS)))
        super().build_extension(ext)

    def _compile(self, source: str) -> list[str]:
        return self.compiler.compile(
            [source],
            output_dir=self.build_temp,
            include_dirs=FOLDERS,
            extra_postargs=NUMERICS,
            depends=HEADERS,
        )


setup(
    packages=sorted({*find_packages(include=["meshonet*"]), *OF_ROOMS}),
    package_dir={f"meshonet.{room}": room for room in ROOMS},
    cmdclass={"build_ext": BuildKernels},
    ext_modules=cythonize(
        Extension(
            "meshonet.kernels._native",
            [str(ROOM / "_native.pyx")],
            include_dirs=FOLDERS,
            extra_compile_args=GLUE,
            extra_link_args=LINK,
            libraries=[] if WINDOWS else ["m", "pthread"],
            depends=[*KERNELS, *HEADERS],
        ),
        language_level=3,
        emit_linenums=False,
        compiler_directives={
            "cdivision": True,
            "binding": False,
            "embedsignature": False,
            "auto_pickle": False,
        },
    ),
)
