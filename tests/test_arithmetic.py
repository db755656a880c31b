"""The same arithmetic on every processor: nothing that NumPy leaves to a BLAS or to the width of vectors.

The linter refuses functions by their names (`banned-api` in pyproject.toml); here is what has none.
`meshonet.geometry.elementary` says what takes their place.
"""

import ast
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("geometry", "formats", "meshonet/api", "meshonet_cli", "solvers")
ELSEWHERE = (
    "formats/figure",  # pictures
    "solvers/neural/fit",  # torch and training
    "solvers/neural/models",
    "solvers/neural/differentiable",
    "solvers/neural/strip/dataset.py",
)
"""Where other arithmetic is used, which no mesh comes from."""
TENSORS = ("solvers/neural/quad/picard.py",)
"""Where products are of torch; arrays of NumPy have a kernel."""
POWERS = (
    "geometry/conformal/lift.py",
    "solvers/algebraic/resample/spline.py",
    "solvers/blocking/block_grid.py",
    "solvers/cascade/passage_flow.py",
    "solvers/blocking/decomposition/surface/triangulation.py",
    "solvers/energy/quad_problem.py",
    "solvers/hyperbolic/default_spacing.py",
    "solvers/hyperbolic/front.py",
    "solvers/neural/quad/canonical_frame.py",
    "solvers/volumes/planes_descent.py",
)
"""Where powers are of single or complex numbers: the C library's, one by one."""
EXACT = (2, 0.5, -1)
"""Exponents for which NumPy multiplies, takes the square root or divides."""


def is_a_matrix_product(node: ast.AST) -> bool:
    """Say whether it is ``a @ b``, ``a @= b`` or ``a.dot(b)``, which are of a BLAS."""
    if isinstance(node, ast.BinOp | ast.AugAssign):
        return isinstance(node.op, ast.MatMult)
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "dot"


def is_a_power_of_arrays(node: ast.AST) -> bool:
    """Say whether it is ``a**b``, but for exact exponents and whole numbers: ``2**53``, ``10**-digits``."""
    if isinstance(node, ast.BinOp):
        base, exponent = node.left, node.right
    elif isinstance(node, ast.AugAssign):
        base, exponent = node.target, node.value
    else:
        return False
    if not isinstance(node.op, ast.Pow) or ast.unparse(exponent) in map(str, EXACT):
        return False
    whole = isinstance(base, ast.Constant) and isinstance(base.value, int)
    return not whole or any(isinstance(part, ast.Call) for part in ast.walk(exponent))


def is_an_unstable_order(node: ast.AST) -> bool:
    """Say whether it is an `argsort` that may exchange equal values, or an `argpartition`, which may."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
        return False
    stable = any(word.arg == "kind" and ast.unparse(word.value) == "'stable'" for word in node.keywords)
    return node.func.attr == "argpartition" or (node.func.attr == "argsort" and not stable)


def python_files(room: str) -> Iterator[str]:
    for path in sorted((ROOT / room).rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        if not any(name == place or name.startswith(f"{place}/") for place in ELSEWHERE):
            yield name


KINDS = (is_a_matrix_product, is_a_power_of_arrays, is_an_unstable_order)


def places(name: str, source: str, is_one: Callable[[ast.AST], bool]) -> list[str]:
    return places_of_each_kind(name, source)[is_one]


def places_of_each_kind(name: str, source: str) -> dict[Callable[[ast.AST], bool], list[str]]:
    uses: dict[Callable[[ast.AST], bool], list[str]] = {kind: [] for kind in KINDS}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.BinOp | ast.AugAssign | ast.Call):
            for kind in KINDS:
                if kind(node):
                    uses[kind].append(f"{name}:{node.lineno}: {ast.unparse(node)}")
    return uses


@cache
def read(room: str) -> dict[str, dict[Callable[[ast.AST], bool], list[str]]]:
    """Return the places in each file: sources are parsed once for all kinds."""
    return {name: places_of_each_kind(name, (ROOT / name).read_text()) for name in python_files(room)}


def places_in(room: str, is_one: Callable[[ast.AST], bool], besides: tuple[str, ...] = ()) -> list[str]:
    files = {name: kinds[is_one] for name, kinds in read(room).items() if name not in besides}
    assert files
    return [place for places in files.values() for place in places]


@pytest.mark.parametrize("room", ROOMS)
def test_products_of_matrices_are_those_of_elementary(room: str) -> None:
    assert places_in(room, is_a_matrix_product, besides=TENSORS) == []


@pytest.mark.parametrize("room", ROOMS)
def test_powers_of_arrays_are_those_of_elementary(room: str) -> None:
    assert places_in(room, is_a_power_of_arrays, besides=POWERS) == []


@pytest.mark.parametrize("room", ROOMS)
def test_equal_values_are_sorted_in_the_order_in_which_they_are(room: str) -> None:
    assert places_in(room, is_an_unstable_order) == []


@pytest.mark.parametrize("source", ["a @ b", "a @= b", "a.dot(b)"])
def test_a_matrix_product_is_seen(source: str) -> None:
    assert places("a", source, is_a_matrix_product)


@pytest.mark.parametrize(
    "source", ["x**3", "x **= 3", "x**k", "2.0**k", "10 ** f(k)", "x**-0.5", "x ** (1 / 3)"]
)
def test_a_power_is_seen(source: str) -> None:
    assert places("a", source, is_a_power_of_arrays)


@pytest.mark.parametrize(
    "source", ["x**2", "x **= 2", "x**0.5", "x**-1", "2**53", "10**-k", "10 ** (1 - k)", "2 * x"]
)
def test_exact_powers_are_used(source: str) -> None:
    assert not places("a", source, is_a_power_of_arrays)


@pytest.mark.parametrize("source", ["np.argsort(x)", "x.argsort(kind='quicksort')", "np.argpartition(x, 3)"])
def test_an_unstable_order_is_seen(source: str) -> None:
    assert places("a", source, is_an_unstable_order)


@pytest.mark.parametrize(
    "source", ["np.argsort(x, kind='stable')", "x.argsort(axis=1, kind='stable')", "np.sort(x)"]
)
def test_a_stable_order_is_used(source: str) -> None:
    assert not places("a", source, is_an_unstable_order)
