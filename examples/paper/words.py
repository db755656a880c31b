"""What the pages of docs/benchmarks/paper say around their tables, and the paper's own figures."""

HEAD = """
# The MeshONet paper, reproduced

<!-- made by make paper -->

Read this page to see which claims of the paper are confirmed: Xiao, Chen, Peng, Wang, Liu, *MeshONet: A Generalizable
and Efficient Operator Learning Method for Structured Mesh Generation*, arXiv 2501.11937.

MeshONet is a neural network that learns to predict the grid of a shape from its boundary. All values here
come from `meshonet` commands: `make paper` samples the six [families of shapes](../../reference/families.md),
solves for their grids, trains the networks, evaluates them and measures the results. The commands are in
`examples/paper/Makefile`; [paper models](../../theory/paper-models.md) describes the networks. The paper
measures quality by the largest included angle of each cell. It shows these angles only in colour maps, without
numbers; this page therefore tests what the paper says in words.
"""

STANDS = """
## Which claims are confirmed
"""

LOWEST = """The paper claims that MeshONet's loss is orders of magnitude below the losses of four other networks, the
baselines. Here all networks are trained on one *budget*: the same shapes, equally often, with the same
learning-rate schedule. Values are mean ± standard deviation over the random seeds. A *case* is a family with a
*split* of its shapes into training and test shapes ([splits](#quality-case-by-case)).

"""

CLAIMS = """
The paper's claims about quality compare MeshONet with transfinite interpolation (TFI) and with a solver of
Winslow's equations (PDE). Here we compare the largest included angle of a grid, averaged over the test grids;
lower is better. The column *max angle against TFI / PDE* says whether MeshONet's angle is below, equal to or
above the angle of TFI / of the PDE solver. The column *claimed* translates the words of the paper: "better"
means below, "as good" equal, and "slightly worse" above. A dash means that the paper makes no claim.

As in the paper, the boundary nodes of the network's output are replaced by the given nodes (*boundary
pasted*). This folds cells if the error of the network at the boundary exceeds the height of the first row of
cells. `meshonet-hard`, our variant of MeshONet, matches the boundary exactly. *Repaired* grids are the output
of `infer` without options, which repairs folded cells. The last four columns are numbers of folded cells in
all test grids together.
"""

SPEED = """
**Speed: not confirmed for a multigrid solver.** The paper reports that MeshONet is four orders of magnitude
faster than a PDE solver, which takes 140 s for 100 x 100 nodes. Depending on the number of nodes, our solver
`solve-pde` takes {times} times as long as MeshONet ([mesh refinement](#mesh-refinement)).
"""

QUALITY = """
## Quality, case by case

Each case has 36 shapes of 101 x 101 nodes: 30 for training and 6 for tests. The split *interpolation* tests
the middle of the range of the family's parameter and trains on both ends, *extrapolation* tests one end, and
*random* tests random parameters. All values are for test grids; *median*, *mean* and *worst* are over these
grids.

*Relative L2* is the root mean square distance between the nodes and the converged Winslow solution, divided by
the root mean square distance of the solution's nodes from their mean. *Boundary error* is the largest distance
of a predicted boundary node from the given node. For each cell the largest included angle is taken, in
degrees: *max angle* is its maximum, and *mean angle* its mean over the cells of a grid.

The networks learn from the grids of the rows *PDE*. For the wrench, Winslow's equations fold 4 to 18
cells of each grid at the two corners of 270 degrees; these cells are repaired. For wrench and airfoil,
`meshonet-hard` uses modes computed from the training grids instead of its trunk network
([reasons](../../theory/paper-models.md#meshonet-hard)).
"""

PAPER = {
    "arch": "The paper claims that MeshONet's grids are better than the grids of TFI and of the PDE solver, in interpolation and extrapolation.",
    "hexagon": "The paper claims that MeshONet's grids are better than the grids of TFI and of the PDE solver, in interpolation and extrapolation.",
    "wrench": "The paper claims that MeshONet's grids are better than the PDE solver's. Compared with TFI's, it claims that they are as good in interpolation and slightly worse in extrapolation.",
    "semicircle": "The paper states, for random positions, that MeshONet's grids are not always better than the grids of traditional methods.",
    "airfoil": "The paper claims that MeshONet's grids are better than TFI's. Compared with the PDE solver's, it claims that they are as good in interpolation and slightly worse in extrapolation.",
    "hole": "The paper claims, for random positions, that MeshONet's grids are better than the grids of traditional methods.",
}

RACE = """
## Loss on one budget

All models are trained on the same budget, with the same random points in each step. Values are mean ±
standard deviation over the random seeds. In the paper's figure of the loss over 100,000 iterations, MeshONet's
loss is orders of magnitude below the others.

`meshonet-hard` learns a correction of an initial grid. Its loss is the error of this correction and
cannot be compared with the other losses; compare the relative L2 errors instead. `fno2d` learns
from every second node in each direction, because all nodes would take four times as long; splines interpolate
its output to 101 x 101 nodes.
"""

SHELF = """
## Every model on every case

All models are trained on all families and splits with one budget: 300 epochs (9,000 shapes) on
grids of 51 x 51 nodes, with the same schedule and the same random points in each step. In the tables of
quality above, networks saw fifty times as many shapes (`meshonet-hard` on the airfoil ten times as many).
Settings are the defaults of each model.

For each of two random seeds, the median of the relative L2 distances of the network's output from the test
grids is taken; the table gives mean ± standard deviation of the two medians. The smallest value of each row
is bold.
"""

AGAINST = """The paper compares MeshONet's loss with those of four baselines on one case; it only cites WNO, KNO and
LNO. If the claim held for errors too, MeshONet's error would be the smaller one in all cases of this list:"""

PHYSICS = """
## Physics-informed networks

Each of these networks, with 5,122 weights, is trained for one geometry only; the time to generate a grid is
therefore the training time (*seconds*). The geometry is the arch of [mesh refinement](#mesh-refinement) with
101 x 101 nodes; *relative L2* is the distance from the converged Winslow solution, as above. The paper gives no
values for these networks; it says that they are as good as the PDE solver but do not generalise.
"""

TIME = """
## Mesh refinement

The table gives seconds from boundary nodes in memory to grid nodes in memory. The shape is an arch that was
not used in training. For more than 512² nodes, `solve-pde` solves on 257² nodes and interpolates the solution.
A dash means that the time was not measured. Our times are for one thread on {machine}; the
paper's MeshONet ran on an RTX 4090.
"""

MAPS = """
## Maps of the largest included angle

The maps show the first test shape of each case.
"""

SETTINGS = """
## Training

The optimiser is Adam with a learning rate of 0.001, which is multiplied by 0.9 after each fifteenth of the
epochs. `meshonet-hard` on wrenches uses 0.003 with a cosine schedule. A step uses 30 shapes, with 1000 random
points inside and 200 on the boundary (a quarter of these for `meshonet-hard` with the setting `modes`). The
loss of `meshonet` is 900 times the mean square error inside plus 1000 times the mean square error on the
boundary. Runs whose names begin with *one* are the physics-informed networks. Seconds count from the last
start of a run.
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
