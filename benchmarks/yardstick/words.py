"""What the page of the comparison says around its tables."""

HEAD = """# A comparison that is open to other programs

<!-- made by python benchmarks/yardstick entries build/yardstick --page docs/benchmarks/yardstick.md -->

Use this page to compare your program for structured grids with Gmsh and meshonet, on random shapes to which
no program was adapted. The scripts in `benchmarks/yardstick` generate the shapes and measure the quality of
the grids. They need only NumPy and h5py.

There are {count} random shapes of each kind, from seed {seed}. All boundary nodes are given.

| kind | nodes | shape |
| --- | --- | --- |
| `wavy` | 65 x 65 | four-sided domain with wavy sides |
| `sector` | 65 x 65 | piece of a ring of 40 to 270 degrees with varying radii |
| `duct` | 65 x 65 | S-shaped duct with a contraction or an expansion |
| `bumps` | 65 x 65 | channel with bumps on both walls |
| `kinked` | 65 x 65 | four-sided domain whose sides are polylines |
| `lens` | 65 x 65 | domain between two arcs, cut off at its ends |
| `star` | 65 x 33 | smooth body with two to seven lobes inside a circle |
| `slab` | 65 x 33 | rectangle with rounded corners inside a circle |
| `section` | 65 x 33 | NACA four-digit airfoil inside a circle |

In the tables, the first six kinds are *four-sided*, the last three *body*.

- `infer`: the default method; with `--model NAME`, a [network](models.md). `tfi`: transfinite interpolation.
- *grids*: shapes for which the program makes a grid.
- *folded*: grids with folded cells and, in brackets, number of folded cells.
- *largest angle*: largest corner angle of a grid, mean / maximum over the grids.
- *smallest angle*: smallest corner angle of all grids.
- *skew*: largest deviation of the corner angles of a cell from 90 degrees, mean over all cells.
- *boundary error*: largest distance of a boundary node from its given position, relative to the size of the
  shape.
- *CPU ms*: CPU time of the whole command in milliseconds, divided by the number of grids.
"""

COLUMNS = """
| shapes | program | grids | folded | largest angle, degrees | smallest angle, degrees | skew, degrees \
| boundary error | CPU ms |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |"""

NETWORKS = """
- `meshonet infer` and `solve-pde` repaired folded cells, except with `--no-repair`. Grids in which folded
  cells remained were written too (`--allow-invalid`).
- One four-sided domain, `wavy-15`, has a corner of 182 degrees, at which every grid has a folded cell.
  `infer` and `solve-pde --method variational` fold no other cells.
- On the four-sided domains the skew is 4.4 degrees with `meshonet infer` and 10.2 degrees with Gmsh and
  smoothing. On the bodies it is 3.8 degrees with `infer --model hole-o` and 8.5 degrees with Gmsh and
  smoothing.

## Networks trained for a short time

The rows `train --model NAME` of the tables are for [MeshONet and other
networks](../theory/paper-models.md) that predict grids.

- `mgnet` and `meshnet` are trained with 500 steps for one geometry, here for the first shape of each kind.
  The training is part of their CPU time.
- The other networks are trained with 300 steps (15 epochs), once on 600 four-sided domains with 33 x 33
  nodes, and once on 576 bodies with 65 x 33 nodes. The training grids are solutions of Winslow's equations.
- The given boundary nodes replace the predicted boundary nodes (`infer --answer pasted`). Folded cells are
  not repaired.
"""

TAIL = """
Almost all grids have folded cells: 300 steps are few, and the shapes are unlike those for training. The [page
of the MeshONet paper](paper/index.md) gives errors after longer training.

## How to enter

1. Generate the shapes.

       python benchmarks/yardstick shapes build/yardstick --seed 1

   Each kind is a file `build/yardstick/KIND.h5`. For n shapes with ni x nj nodes it has the arrays `south`,
   `north` (n, ni, 2), `west`, `east` (n, nj, 2) and `names`. For a body, south is the body, clockwise, and
   north is the circle. West and east are the two sides of one cut from the body to the circle; your program
   may move the nodes of this cut.

   With the option `--plot3d` each kind is also a folder `KIND` with a 2D ASCII Plot3D file for each shape.
   The four blocks of the file are the sides.

2. Run your program. It gets two paths: boundaries to read and grids to write.

       python benchmarks/yardstick run build/yardstick 'My program 1.0' 'myprogram --in {boundaries} --out {grids}'

   Grids are a `.h5` file with `nodes` (n, ni, nj, 2) and `names`, or with `--plot3d` a folder of Plot3D
   files with the names of the shapes. Leave out shapes for which your program makes no grid. The script
   `benchmarks/yardstick/gmsh_transfinite.py` is an example.

3. Measure all grids in the folder. The printed rows have the columns of the tables above.

       python benchmarks/yardstick judge build/yardstick

Use another `--seed` to see whether a result depends on the shapes. `python benchmarks/yardstick entries
build/yardstick` makes the tables above.
"""
