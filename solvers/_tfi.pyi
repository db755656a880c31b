from geometry.arrays import Floats

Edges = tuple[Floats, Floats, Floats, Floats]

def fill(x: Floats, y: Floats, xs: Edges, ys: Edges, parameters: Edges) -> None: ...
