"""What the page of the comparison says around its table."""

HEAD = """# A comparison that is open to other programs

<!-- made by python benchmarks/yardstick entries build/yardstick --page docs/benchmarks/yardstick.md -->

Use this page to compare a program that makes structured grids with the ones below, on shapes that none of them was
made for. Shapes, judge and files are in `benchmarks/yardstick`: a few hundred lines that need NumPy and h5py, and nothing
of meshonet.

Nine kinds of shapes are drawn by seed, here {count} of each with seed {seed}: four-sided domains with 65 x 65 nodes (`wavy`,
`sector`, `duct`, `bumps`, `kinked`, `lens`) and bodies with 65 x 33 nodes (`star`, `slab`, `section`). The boundary nodes are
given. *Folded* are grids, and in brackets cells, with a corner whose Jacobian is not positive. Angles are included angles of
cells in degrees. *Skew* is the mean over cells of the largest deviation of an angle from 90 degrees. The boundary error is
relative to the size of the shape. Milliseconds are processor time of the whole command per shape; the start of the program
is part of it.

| shapes | program | grids | folded | largest angle, mean / worst | least angle | skew | boundary error | ms |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |"""

TAIL = """
Folded cells are repaired by `meshonet`, except with `--no-repair`. Networks that are trained on one family of shapes, such as those of [the paper](paper/index.md), are not among the entries: they answer
shapes of their family only.

## How to enter

1. Draw the shapes. Every kind is one file, `build/yardstick/KIND.h5`, with the arrays `south`, `north` (n, ni, 2), `west`,
   `east` (n, nj, 2) and `names`. With `--plot3d` there is also a folder `KIND` with a 2D ASCII Plot3D file for each shape,
   whose four blocks are the sides. Around a body, south is the body, clockwise, and north the far field; west and east are
   the same cut, which may move.

       python benchmarks/yardstick shapes build/yardstick --seed 1

2. Run your program. It gets the file (or, with `--plot3d`, the folder) of the boundaries and the path of the grids to write:
   a `.h5` file with `nodes` (n, ni, nj, 2) and `names`, or a folder of Plot3D files with the names of the shapes. Shapes that
   your program cannot do may be left out.

       python benchmarks/yardstick run build/yardstick 'My program 1.0' 'myprogram --in {boundaries} --out {grids}'

3. Judge all grids in the folder.

       python benchmarks/yardstick judge build/yardstick

Use another seed to check that a result does not hang on these shapes. `gmsh_transfinite.py` is an entry of 90 lines to start
from.
"""
