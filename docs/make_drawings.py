"""Draw the cells of docs/reference/quality.md and the grids of docs/theory: python docs/make_drawings.py."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import meshonet

FOLDER = Path(__file__).parent / "img" / "drawn"
INK, GOOD, BAD, FAINT = "#1b2a41", "#2a7f9e", "#d1495b", "#9aa5b8"
Points = NDArray[np.float64] | Sequence[Sequence[float]]


class Drawing:
    """An SVG picture in units of its own, y upwards."""

    def __init__(self, x: tuple[float, float], y: tuple[float, float], width: int) -> None:
        self.x, self.y, self.scale = x, y, width / (x[1] - x[0])
        self.size = width, round((y[1] - y[0]) * self.scale)
        self.parts: list[str] = []

    def place(self, points: Points) -> str:
        """Return points as SVG has them."""
        to = np.array([-self.x[0], -self.y[1]])
        pixels = (np.asarray(points, dtype=float) + to) * [self.scale, -self.scale]
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in pixels)

    def line(self, points: Points, colour: str = INK, width: float = 1.0, dash: str = "") -> None:
        """Draw an open line."""
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polyline points="{self.place(points)}" fill="none" stroke="{colour}" '
            f'stroke-width="{width}"{dashed}/>'
        )

    def area(self, points: Points, colour: str = GOOD, ink: str = INK) -> None:
        """Draw a filled polygon."""
        self.parts.append(
            f'<polygon points="{self.place(points)}" fill="{colour}" fill-opacity="0.18" stroke="{ink}" '
            'stroke-width="1.4" stroke-linejoin="round"/>'
        )

    def arc(self, at: Points, first: Points, second: Points, radius: float, colour: str) -> None:
        """Draw the angle at a point between the directions to two others."""
        centre = np.asarray(at, dtype=float)
        a, b = (np.arctan2(*(np.asarray(p, dtype=float) - centre)[::-1]) for p in (first, second))
        turn = np.linspace(a, a + (b - a) % (2 * np.pi), 24)
        self.line(centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), colour, 1.8)

    def dots(self, points: Points, colour: str = INK, radius: float = 2.5) -> None:
        """Draw nodes."""
        for pair in self.place(points).split():
            x, y = pair.split(",")
            self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius}" fill="{colour}"/>')

    def text(self, at: Points, words: str, colour: str = INK, size: int = 13, anchor: str = "middle") -> None:
        """Write words."""
        x, y = self.place([at]).split(",")  # type: ignore[list-item]
        self.parts.append(
            f'<text x="{x}" y="{y}" fill="{colour}" font-size="{size}" text-anchor="{anchor}">{words}</text>'
        )

    def grid(self, nodes: NDArray[np.float64], colour: str = GOOD, width: float = 0.8) -> None:
        """Draw both families of lines."""
        for line in (*nodes, *nodes.transpose(1, 0, 2)):
            self.line(line, colour, width)

    def save(self, name: str, title: str) -> None:
        """Write the picture to docs/img/drawn."""
        FOLDER.mkdir(parents=True, exist_ok=True)
        width, height = self.size
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}" font-family="sans-serif" role="img">'
        )
        body = [
            head,
            f"<title>{title}</title>",
            '<rect width="100%" height="100%" fill="#fff"/>',
            *self.parts,
        ]
        (FOLDER / f"{name}.svg").write_text("\n".join([*body, "</svg>\n"]), encoding="utf-8")


def main() -> None:
    """Draw everything."""
    for draw in (angles, skewness, jacobian, aspect, orthogonality, growth, area_ratio, folded):
        draw()
    for draw in (
        interpolation,
        coarse,
        winslow,
        variational,
        marching,
        conformal,
        blocks,
        faces,
        network,
        levels,
        channel,
    ):
        draw()


# --- cells: left as it should be, right as it should not


def pair(good: Points, bad: Points) -> tuple[Drawing, NDArray[np.float64], NDArray[np.float64]]:
    """Return a drawing of two cells, and their corners."""
    drawing = Drawing((-0.25, 3.35), (-0.45, 1.3), 360)
    left, right = np.asarray(good, dtype=float), np.add(bad, [1.9, 0.0])
    drawing.area(left, GOOD)
    drawing.area(right, BAD)
    return drawing, left, right


SQUARE = ((0, 0), (1.1, 0), (1.1, 1), (0, 1))
SLANTED = ((0, 0), (0.75, 0), (1.3, 1), (0.5, 0.85))


def angles() -> None:
    """Draw largest and smallest angle of a cell."""
    drawing, left, right = pair(SQUARE, SLANTED)
    drawing.arc(left[1], left[2], left[0], 0.2, GOOD)
    drawing.text((0.55, -0.3), "all angles 90°")
    drawing.arc(right[3], right[0], right[2], 0.2, BAD)
    drawing.arc(right[2], right[3], right[1], 0.25, GOOD)
    drawing.text((2.45, -0.3), "largest 131°, smallest 51°")
    drawing.save("angles", "Corner angles of a cell")


def skewness() -> None:
    """Draw the deviation of the worst angle from 90 degrees."""
    drawing, _, right = pair(SQUARE, SLANTED)
    drawing.text((0.55, -0.3), "skewness 0")
    along = (right[2] - right[3]) / np.linalg.norm(right[2] - right[3])
    normal = right[3] + 0.6 * np.array([along[1], -along[0]])
    drawing.line([right[3], normal], FAINT, 1.4, "4 3")
    drawing.arc(right[3], right[0], normal, 0.42, BAD)
    drawing.text(right[3] + [-0.12, -0.6], "41°", BAD, 12)
    drawing.text((2.45, -0.3), "41° off 90: 41/90 = 0.46")
    drawing.save("skewness", "Equiangle skewness: the worst deviation from 90 degrees, over 90")


def jacobian() -> None:
    """Draw the Jacobian at the worst corner."""
    drawing, _, right = pair(SQUARE, SLANTED)
    drawing.text((0.55, -0.3), "u × v / (|u| |v|) = 1")
    for k, name, shift in ((0, "u", (-0.14, 0.05)), (2, "v", (0, 0.1))):
        drawing.line([right[3], right[k]], BAD, 3)
        drawing.text((right[3] + right[k]) / 2 + shift, name, BAD)
    drawing.text((2.45, -0.3), "0.75 at the worst corner")
    drawing.save("jacobian", "Scaled Jacobian: the sine of the worst corner angle")


def aspect() -> None:
    """Draw a long cell."""
    drawing, _, right = pair(SQUARE, ((0, 0.4), (1.3, 0.4), (1.3, 0.66), (0, 0.66)))
    drawing.text((0.55, -0.3), "aspect ratio near 1")
    drawing.line([right[0] - [0, 0.1], right[1] - [0, 0.1]], BAD, 2)
    drawing.text((2.55, -0.3), "3; in boundary layers 1000")
    drawing.save("aspect", "Aspect ratio: long against short")


def orthogonality() -> None:
    """Draw the two lines through the middles of sides."""
    drawing, *cells = pair(SQUARE, SLANTED)
    for cell, colour in zip(cells, (GOOD, BAD), strict=True):
        middle = (cell + np.roll(cell, -1, axis=0)) / 2
        drawing.line([middle[0], middle[2]], colour, 1.6, "5 3")
        drawing.line([middle[3], middle[1]], colour, 1.6, "5 3")
        drawing.arc(cell.mean(axis=0), middle[1], middle[2], 0.2, colour)
    drawing.text((0.55, -0.3), "orthogonality 90°")
    drawing.text((2.35, -0.3), "orthogonality 55°")
    drawing.save("orthogonality", "Orthogonality: the angle between grid lines at the centre")


def _stack(drawing: Drawing, heights: Sequence[float], left: float, colour: str) -> None:
    base = 0.0
    for height in heights:
        drawing.area(
            [(left, base), (left + 1, base), (left + 1, base + height), (left, base + height)], colour
        )
        base += height


def growth() -> None:
    """Draw rows of cells at a wall."""
    drawing = Drawing((-0.25, 3.35), (-0.45, 1.3), 360)
    _stack(drawing, (0.16, 0.19, 0.23, 0.28, 0.33), 0.0, GOOD)
    _stack(drawing, (0.05, 0.12, 0.27, 0.7), 1.9, BAD)
    for left in (0.0, 1.9):
        drawing.line([(left - 0.1, 0), (left + 1.1, 0)], INK, 4)
    drawing.text((0.5, -0.3), "growth 1.2")
    drawing.text((2.4, -0.3), "growth 2.4")
    drawing.save("growth", "Growth: ratio of neighbouring heights off a wall")


def area_ratio() -> None:
    """Draw two neighbours."""
    drawing = Drawing((-0.25, 3.35), (-0.45, 1.3), 360)
    for left, middle, colour in ((0.0, 0.6, GOOD), (1.9, 0.25, BAD)):
        for a, b in ((0.0, middle), (middle, 1.3)):
            drawing.area([(left + a, 0.1), (left + b, 0.1), (left + b, 0.9), (left + a, 0.9)], colour)
    drawing.text((0.65, -0.3), "area ratio 1.2")
    drawing.text((2.55, -0.3), "area ratio 4.2")
    drawing.save("area-ratio", "Area ratio: a cell against its neighbour")


def folded() -> None:
    """Draw an inverted cell."""
    drawing, _, right = pair(SQUARE, ((0, 0), (1.1, 0), (0.25, 0.3), (0, 1)))
    drawing.arc(right[2], right[3], right[1], 0.14, BAD)
    drawing.text((0.55, -0.3), "every corner turns left")
    drawing.text((2.45, -0.3), "folded: one turns right")
    drawing.save("folded", "A folded cell: the Jacobian of a corner is negative")


# --- grids of methods


def duct() -> meshonet.Boundary:
    """Return a duct over a bump."""
    x = np.linspace(0.0, 2.0, 29)
    bump = 0.5 * np.exp(-30.0 * (x - 0.8) ** 2)
    south, north = np.stack([x, bump], axis=1), np.stack([x, 1.0 + 0.2 * bump], axis=1)
    y = np.linspace(0.0, 1.0, 15)[:, None]
    west, east = (south[k] + y * (north[k] - south[k]) for k in (0, -1))
    return meshonet.Boundary(south, north, west, east)


def _of_duct(method: str, name: str, title: str) -> None:
    drawing = Drawing((-0.05, 2.05), (-0.05, 1.15), 420)
    edges = duct()
    drawing.grid(meshonet.grid(edges, method=method, repair=False, allow_invalid=True).nodes)
    for side in (edges.south, edges.north, edges.west, edges.east):
        drawing.line(side, INK, 2)
    drawing.save(name, title)


def interpolation() -> None:
    """Draw the grid of interpolation."""
    _of_duct("tfi", "interpolation", "Transfinite interpolation copies the walls into the domain")


def winslow() -> None:
    """Draw the grid of Winslow's equations."""
    _of_duct("winslow", "winslow", "Winslow's grid: lines keep away from the hollow and crowd over the bump")


def variational() -> None:
    """Draw the variational grid."""
    _of_duct("variational", "variational", "The variational grid: angles near 90 degrees")


def coarse() -> None:
    """Draw a coarse grid within a fine one."""
    drawing = Drawing((-0.05, 2.05), (-0.05, 1.15), 420)
    nodes = meshonet.grid(duct(), method="variational").nodes
    drawing.grid(nodes, FAINT, 0.6)
    drawing.grid(nodes[::4, ::2], GOOD, 1.3)
    drawing.dots(nodes[::4, ::2].reshape(-1, 2))
    drawing.save("coarse", "Solved at the dots, evaluated by splines at every node")


def marching() -> None:
    """Draw rows that grow from a wall."""
    drawing = Drawing((-0.3, 2.3), (-0.2, 1.0), 420)
    x = np.linspace(0.0, 2.0, 25)
    wall = np.stack([x, 0.1 * np.sin(np.pi * x)], axis=1)
    normal = np.stack([-0.1 * np.pi * np.cos(np.pi * x), np.ones_like(x)], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    heights = 0.02 * (1.35 ** np.arange(9) - 1) / 0.35
    rows = np.stack([wall + height * normal for height in heights], axis=1)
    drawing.grid(rows)
    drawing.line(wall, INK, 4)
    drawing.line([rows[12, -1], rows[12, -1] + 0.24 * normal[12]], BAD, 2)
    drawing.text(rows[12, -1] + [0.08, 0.16], "next row", BAD, 13, "start")
    drawing.save("marching", "Rows grow from the wall, at right angles to the row below")


def conformal() -> None:
    """Draw the plane of an airfoil and the strip that it is mapped to."""
    drawing = Drawing((-0.6, 4.0), (-0.75, 0.75), 640)
    nodes = meshonet.grid("naca:2412", res=(49, 13), far_field=1.2).nodes
    near = nodes[:, :7]
    drawing.grid(near)
    drawing.line(nodes[:, 0], INK, 2)
    strip = np.stack(
        np.meshgrid(np.linspace(2.3, 3.9, 25), np.linspace(-0.5, 0.5, 9), indexing="ij"), axis=-1
    )
    drawing.grid(strip)
    drawing.line(strip[:, 0], INK, 3)
    drawing.line([(1.85, 0), (2.15, 0)], BAD, 2)
    drawing.line([(2.08, 0.05), (2.15, 0), (2.08, -0.05)], BAD, 2)
    drawing.text((3.1, -0.68), "wall")
    drawing.text((3.1, 0.58), "far field")
    drawing.save("conformal", "The plane of the airfoil, and the strip in which the equations are solved")


def blocks() -> None:
    """Draw the blocks of a plate with two holes."""
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    plate = np.array([[-2, -1], [2, -1], [2, 1], [-2, 1]], dtype=float)
    domain = meshonet.Domain.of_polygons([plate, 0.4 * circle + [-0.9, 0], 0.4 * circle + [0.9, 0]], "plate")
    grid = meshonet.solve_pde(domain, cells=700)
    drawing = Drawing((-2.05, 2.05), (-1.05, 1.05), 460)
    for block in grid.blocks:
        drawing.grid(block.nodes[..., :2], FAINT, 0.6)
        for line in (block.nodes[0], block.nodes[-1], block.nodes[:, 0], block.nodes[:, -1]):
            drawing.line(line[:, :2], INK, 1.8)
    drawing.save("blocks", "A plate with two holes: blocks, and the cells in them")


def _oblique(points: Iterable[Sequence[float]]) -> NDArray[np.float64]:
    x, y, z = np.asarray(list(points), dtype=float).T
    return np.stack([x + 0.42 * y, z + 0.3 * y], axis=1)


def faces() -> None:
    """Draw a block and its inner lines."""
    drawing = Drawing((-0.1, 1.6), (-0.1, 1.45), 300)
    t = np.linspace(0.0, 1.0, 21)

    def wall(x: float, y: float, z: float) -> tuple[float, float, float]:
        return x, y, z + 0.12 * np.sin(np.pi * x) * (1 - 0.5 * y)

    lines = [[(s, a, b) for s in t] for a in (0, 1) for b in (0, 1)]
    lines += [[(a, s, b) for s in t] for a in (0, 1) for b in (0, 1)]
    lines += [[(a, b, s) for s in t] for a in (0, 1) for b in (0, 1)]
    for share in (0.25, 0.5, 0.75):
        drawing.line(_oblique(wall(s, share, 1) for s in t), GOOD)
        drawing.line(_oblique(wall(share, s, 1) for s in t), GOOD)
        drawing.line(_oblique(wall(s, 0, share) for s in t), GOOD)
        drawing.line(_oblique(wall(share, 0, s) for s in t), GOOD)
        drawing.line(_oblique(wall(1, s, share) for s in t), GOOD)
        drawing.line(_oblique(wall(1, share, s) for s in t), GOOD)
    for line in lines:
        x, y, z = ({point[k] for point in line} for k in range(3))
        hidden = (x, z) == ({0}, {0}) or (y, z) == ({1}, {0}) or (x, y) == ({0}, {1})
        drawing.line(_oblique(wall(*p) for p in line), FAINT if hidden else INK, 1.2 if hidden else 2.0)
    drawing.save("faces", "Six faces in, the nodes between them out")


def network() -> None:
    """Draw the way from a boundary to a grid."""
    drawing = Drawing((0.0, 8.2), (0.0, 1.5), 660)
    steps = ("boundary", "initial grid", "network", "zero at walls", "splines", "check")
    for k, step in enumerate(steps):
        left = 0.1 + 1.36 * k
        drawing.area([(left, 0.5), (left + 1.14, 0.5), (left + 1.14, 1.0), (left, 1.0)], GOOD)
        drawing.text((left + 0.57, 0.7), step, size=12)
        if k < len(steps) - 1:
            drawing.line([(left + 1.16, 0.75), (left + 1.34, 0.75)], INK, 1.6)
    drawing.line([(2.03, 1.0), (2.03, 1.3), (4.75, 1.3), (4.75, 1.0)], FAINT, 1.4, "4 3")
    drawing.text((3.4, 1.35), "plus the correction", FAINT, 12)
    drawing.save("network", "Boundary, initial grid, correction by a network, evaluation, check")


def levels() -> None:
    """Draw a surface of patches and the levels over it."""
    drawing = Drawing((-1.75, 1.75), (-0.2, 1.6), 420)
    turn = np.linspace(np.pi, 0.0, 25)
    wall = np.stack([np.cos(turn), 0.55 * np.sin(turn)], axis=1)
    rows = np.stack([wall * [1 + 0.8 * d, 1 + 1.4 * d] for d in (0, 0.06, 0.14, 0.25, 0.4, 0.6)], axis=1)
    drawing.grid(rows)
    for k in (0, 8, 16, 24):
        drawing.line(rows[k], BAD, 2)
    drawing.line(wall, INK, 4)
    drawing.line([(-1.7, 0), (1.7, 0)], FAINT, 1.4, "5 3")
    drawing.text((0.0, 0.2), "patches")
    drawing.text((0.0, -0.15), "plane of symmetry", FAINT, 12)
    drawing.save("levels", "Patches of a surface and the levels marched off them; red: between blocks")


def channel() -> None:
    """Draw the channel of a blade row with its key sections, and one of them unrolled."""
    drawing = Drawing((-0.3, 7.6), (-0.45, 2.3), 660)
    s = np.linspace(0.0, 1.0, 41)
    hub = np.stack([3.0 * s, 0.35 * s**2], axis=1)
    shroud = np.stack([3.0 * s, 2.0 - 0.25 * s], axis=1)
    tip = hub + 0.94 * (shroud - hub)
    for part in (1.0 - np.cos(np.linspace(0.0, np.pi, 9))) / 2.0:
        drawing.line(hub + part * (tip - hub), GOOD, 0.8)
    for line in (hub, shroud):
        drawing.line(line, INK, 2.4)
    for k in range(0, 41, 5):
        drawing.line([hub[k], shroud[k]], FAINT, 0.8, "3 3")
    drawing.area([hub[14], hub[25], tip[23], tip[16]], BAD)
    drawing.text((1.5, 0.95), "blade", BAD, 12)
    drawing.text((1.5, 2.1), "shroud, h = 1", INK, 12)
    drawing.text((0.3, -0.2), "hub, h = 0", INK, 12, "start")
    drawing.text((3.08, 1.6), "gap", INK, 12, "start")
    drawing.text((3.08, 0.9), "x, r", FAINT, 12, "start")
    t = np.linspace(0.0, 2.0 * np.pi, 61)
    a, b = 0.62 * np.cos(t), 0.07 * np.sin(t) + 0.1 * (1.0 - np.cos(t) ** 2)
    c, d = np.cos(0.7), np.sin(0.7)
    blade = np.stack([5.5 + a * c - b * d, 0.9 + a * d + b * c], axis=1)
    side = np.array([[4.0, 0.45], [5.0, 0.45], [5.95, 1.25], [7.0, 1.25]])
    for shift in (-0.45, 0.65):
        drawing.line(side + np.array([0.0, shift]), GOOD, 1.6)
    drawing.line([[4.0, 0.0], [4.0, 1.1]], INK, 1.6)
    drawing.line([[7.0, 0.8], [7.0, 1.9]], INK, 1.6)
    drawing.area(blade, BAD)
    drawing.line([[4.3, 0.0], [4.3, 1.1]], FAINT, 1.2, "3 3")
    drawing.text((4.36, 0.5), "2π/N", FAINT, 12, "start")
    drawing.text((5.9, 0.3), "m', θ at constant h", FAINT, 12, "start")
    drawing.save("channel", "The channel in x and r with key sections, and one of them in m' and theta")


if __name__ == "__main__":
    main()
