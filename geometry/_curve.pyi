import numpy as np

from meshonet.geometry.arrays import Floats

Indices = np.ndarray[tuple[int, ...], np.dtype[np.intp]]

def locate(
    s: Floats,
    table: Floats,
    start: Floats,
    stop: Floats,
    pieces: int,
    closed: bool,
    interval: Indices,
    place: Floats,
) -> None: ...
def values(cubic: Floats, interval: Indices, place: Floats, end: Floats, points: Floats) -> None: ...
def slopes(cubic: Floats, interval: Indices, place: Floats, derivatives: Floats) -> None: ...
def speeds(cubic: Floats, places: Floats, found: Floats) -> None: ...
