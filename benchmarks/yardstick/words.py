"""What the page of the comparison says around its table."""

HEAD = """# A comparison that is open to other programs

<!-- made by python benchmarks/yardstick entries build/yardstick --page docs/benchmarks/yardstick.md -->

Use this page to compare your program for structured grids with the programs below, on random shapes to which
no program was adapted. The scripts in `benchmarks/yardstick` draw the shapes, read and write the files and
judge the grids. The scripts need NumPy and h5py, and do not use meshonet.

There are nine kinds of random shapes, here {count} of each, drawn with seed {seed}. Six kinds are four-sided domains with
65 x 65 nodes: `wavy`, `sector`, `duct`, `bumps`, `kinked` and `lens`. Three are bodies with 65 x 33 nodes: `star`, `slab`
and `section`. The boundary nodes are given.

- *Grids*: the number of shapes for which the program made a grid.
- *Folded*: number of grids with folded cells and, in brackets, number of folded cells. A cell is folded if
  the Jacobian at one of its corners is not positive.
- *Largest angle*: largest corner angle in a grid, in degrees; mean and worst value over the grids. *Least
  angle*: smallest corner angle in all grids, in degrees.
- *Skew*: largest deviation of the angles of a cell from 90 degrees, in degrees; mean over the cells of all
  grids.
- *Boundary error*: the largest distance of a boundary node from the given node, relative to the size of the
  shape.
- *ms*: milliseconds of processor time of the whole command, start included, divided by the number of grids.

| shapes | program | grids | folded | largest angle, mean / worst | least angle | skew | boundary error | ms |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |"""

TAIL = """
`meshonet` repairs folded cells, except with `--no-repair` and in the rows `meshonet train`. All commands have
the option `--allow-invalid`, so grids with folded cells are written too. One four-sided domain, `wavy-15`,
has a corner of 182 degrees, at which every grid with the given boundary nodes has a folded cell.

The rows `meshonet train` are the [networks of the MeshONet paper](../theory/paper-models.md) and the
operators with which the paper compares them. Each operator is trained twice, with its default settings, seed
0 and 15 epochs: on 600 four-sided domains with 33 x 33 nodes, and on 576 bodies with 65 x 33 nodes (the
bodies, of 600 random ones, for which Winslow's iteration converges). Each training processes about 9,000
shapes in 300 steps, as in [the table of every model on every case](paper/index.md#every-model-on-every-case).
The grids for training are Winslow's grids of random shapes of `sample-boundary --family four-sided` and
`--family bodies`; the nine kinds of shapes on this page are not used in training. As in the paper, the
boundary nodes of a predicted grid are replaced by the given nodes (`infer --answer pasted`). Almost all grids
of these operators have folded cells, for two reasons: 300 steps are few, and the shapes on this page differ
in size and position from the shapes for training. [The page of the paper](paper/index.md) gives their errors
on one family of shapes after longer training.

A network `mgnet` or `meshnet` is trained for one geometry, here for the first
shape of each kind only, with 500 steps; the column *ms* includes this training.

## How to enter

1. Draw the shapes. Each kind is a file `build/yardstick/KIND.h5` with the arrays `south`, `north` (n, ni, 2),
   `west`, `east` (n, nj, 2) and `names`. With `--plot3d` each kind is also a folder `KIND` with a 2D ASCII
   Plot3D file for each shape; the four blocks of the file are the sides. For a body, south is the body,
   clockwise, and north is the far field. West and east are the two sides of one cut from the body to the far
   field; your program may move the nodes of this cut.

       python benchmarks/yardstick shapes build/yardstick --seed 1

2. Run your program. It gets two paths: the file of boundaries to read, and the file of grids to write. Grids
   are a `.h5` file with `nodes` (n, ni, nj, 2) and `names`, or with `--plot3d` a folder of Plot3D files with
   the names of the shapes. Leave out shapes for which your program makes no grid.

       python benchmarks/yardstick run build/yardstick 'My program 1.0' 'myprogram --in {boundaries} --out {grids}'

3. Judge all grids in the folder.

       python benchmarks/yardstick judge build/yardstick

Draw other shapes with another `--seed` to see whether a result depends on the shapes. You can start from the
entry `gmsh_transfinite.py`, which has 80 lines. `python benchmarks/yardstick entries build/yardstick` makes
the table above.
"""
