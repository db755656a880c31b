"""What the pages of docs/benchmarks/paper say around their tables, and the paper's own figures."""

HEAD = """
# The MeshONet paper, reproduced

<!-- made by make paper -->

Read this page to see which claims of the MeshONet paper are confirmed if its networks are trained again:
Xiao, Chen, Peng, Wang, Liu, *MeshONet: A Generalizable and Efficient Operator Learning Method for Structured
Mesh Generation*, arXiv 2501.11937. MeshONet is a neural network that predicts the grid of a shape from the
boundary. It is compared with two solvers and nine other networks, on six [families of
shapes](../../reference/families.md). [Paper models](../../theory/paper-models.md) describes the networks.

`make paper` makes all values, with the `meshonet` commands in `examples/paper/Makefile`.

- *TFI*: transfinite interpolation.
- *PDE*: multigrid solver of Winslow's equations, `solve-pde`.
- *MeshONet-hard*: our variant of MeshONet, `meshonet-hard`, which keeps the given boundary nodes.
- *network output*: the predicted grid without any change.
- *boundary pasted*: the given boundary nodes replace the predicted boundary nodes, as in the paper.
- *repaired*: boundary pasted and folded cells repaired, as `infer` does by default.
- *interpolation*: the training shapes are at both ends of the parameter range of a family, the test shapes in
  the middle. *extrapolation*: the test shapes are at one end. *random*: all shapes have random parameters.
- *largest angle*, *mean angle*: maximum and mean of the largest angles of the cells of a grid, in degrees.
- *relative L2*: RMS distance of the nodes from the grid of the PDE solver, divided by the RMS distance of the
  nodes of this grid from their centroid.
- *boundary error*: largest distance of a boundary node from the given node.
"""

STANDS = """
## Which claims are confirmed
"""

LOWEST = """The paper claims that MeshONet's loss is orders of magnitude below the losses of four *baselines*: the
networks `deeponet`, `pod-deeponet`, `fno1d` and `fno2d`. Here all networks are trained on one *budget*: the
same shapes, equally often ([losses](#loss-on-one-budget)).

"""

CLAIMS = """
The paper shows the largest angle in colour maps without numbers. It states in words whether MeshONet's grids
are better than those of TFI and of the PDE solver. The table compares the largest angles, averaged over the
test grids; the grids of MeshONet have the boundary pasted.

- *measured*: MeshONet's largest angle is *below*, *above* or *equal* to that of TFI or PDE; *equal* is
  a difference of at most 0.1 degrees.
- *claimed*: *below* stands for "better", *equal* for "as good", and *above* for "slightly worse". Of the
  semicircle the paper says only that MeshONet's grids are not always better.
"""

SPEED = """
**Speed: not confirmed for a multigrid solver.** The paper claims that MeshONet is four orders of magnitude
faster than a PDE solver, which takes 140 s for 100 x 100 nodes. Our solver `solve-pde` takes {times} times as
long as MeshONet, depending on the number of nodes ([times](#mesh-refinement)).
"""

QUALITY = """
## Quality, case by case

Each case has 30 training shapes and 6 test shapes of 101 x 101 nodes. The networks learn from the grids of
the PDE solver. All statistics are over the test shapes: *boundary error* is the largest, *mean angle* the
mean, and *folded cells* the total.

In the PDE solver's grids of the wrench, 4 to 18 cells at the two corners of 270 degrees were folded. They
were repaired before the training, by moving all nodes within 12 cells of a folded cell. The number 12 was
chosen after looking at all grids, including the test grids.
"""

RACE = """
## Loss on one budget

All networks are trained on the same shapes, with the same learning rates and the same random points in each
step. Values are mean ± standard deviation over the random seeds.

- *loss*: mean square error inside plus mean square error on the boundary, at the end of training.
  `meshonet-hard` predicts a correction of an initial grid; its loss is not comparable.
- `fno2d` learns from every second node in each direction. Splines interpolate its output to 101 x 101 nodes.
"""

SHELF = """
## Every model on every case

All networks are trained on all cases with a smaller budget: 300 epochs (9,000 shapes) on grids of 51 x 51
nodes. *Error* is the relative L2 distance of the network output, median over the test grids. The second table
gives the errors as mean ± standard deviation of two random seeds. The smallest error of each row is bold.
"""

PHYSICS = """
## Physics-informed networks

Each of these networks is trained for one geometry, the arch of [mesh refinement](#mesh-refinement) with 101 x
101 nodes. As every geometry needs a training, the training time is the time to generate a grid. The paper
says without giving numbers that such networks are as good as the PDE solver but do not generalise.
"""

TIME = """
## Mesh refinement

The table gives the time in seconds to compute the grid of an arch that was not used in training; reading and
writing files is not counted. For more than 512² nodes, `solve-pde` solves on 257² nodes and interpolates. A
dash means not measured. Our programs ran in one thread on {machine}; the paper's MeshONet ran on an RTX 4090.
"""

MAPS = """
## Maps of the largest included angle

The maps show the first test shape of each case.
"""

SETTINGS = """
## Training

The tables of quality are for networks trained for 15,000 epochs of 30 shapes, `meshonet-hard` on the airfoil
for 3,000 epochs. Adam's learning rate starts at 0.001 and is multiplied by 0.9 after each of 15 equal parts
of the training. A step uses 30 shapes, 1,000 random points inside and 200 on the boundary. The training of
`meshonet` minimises 900 times the mean square error inside plus 1,000 times that on the boundary.

On wrench and airfoil `meshonet-hard` has [other settings](../../theory/paper-models.md#meshonet-hard).
"""

SECONDS = {
    "TFI": {100: "0.087", 200: "0.218", 400: "0.928", 800: "3.817", 1600: "15.238", 3200: "72.121"},
    "PDE": {100: "140.331", 200: "586.170", 400: "2360.705", 800: "9795.884"},
    "MeshONet": {100: "0.001", 200: "0.002", 400: "0.002", 800: "0.006", 1600: "0.026", 3200: "0.278"},
}

TIMED = {
    "tfi": "TFI (`tfi`)",
    "pde": "PDE (`solve-pde`, multigrid)",
    "coarse": "PDE on 65 x 65, interpolated (`solve-pde --coarse 65`)",
    "meshonet": "MeshONet (`infer`)",
    "meshonet-hard": "MeshONet-hard (`infer`)",
}
