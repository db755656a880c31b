from typing import Any

from numpy.typing import NDArray

INTEGER_BYTES: int
FLOAT_BYTES: int

def put_integers(out: NDArray[Any], rows: NDArray[Any], text: bytes, at: NDArray[Any]) -> int: ...
def put_floats(out: NDArray[Any], rows: NDArray[Any], text: bytes, at: NDArray[Any]) -> int: ...
