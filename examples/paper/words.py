"""What the pages of docs/benchmarks/paper say around their tables, and the paper's own figures."""

HEAD = """
# The MeshONet paper, reproduced

<!-- made by make paper -->

Read this page to see which claims of the paper are confirmed: Xiao, Chen, Peng, Wang, Liu, *MeshONet: A Generalizable
and Efficient Operator Learning Method for Structured Mesh Generation*, arXiv 2501.11937.

All figures come from `meshonet` commands: `make paper` samples the six families, solves, trains, infers and measures;
`examples/paper/Makefile` is the recipe. The models are described in [paper models](../../theory/paper-models.md). The
paper measures quality by the largest included angle and shows it as colour maps without numbers. Its claims are
therefore quoted in words beside our figures.
"""

STANDS = """
## Which claims are confirmed
"""

CLAIMS = """
**Quality**: the largest included angle of MeshONet's grids, averaged over the test grids, compared with TFI and the PDE
solver. Lower is better. As in the paper, the true boundary is pasted over the network's output. The network's boundary
has an error, and where it exceeds the height of the first row, pasting folds the cells there. `meshonet-hard` meets the
boundary exactly and needs no pasting. *Repaired* is the output of `infer` with its defaults, in which folded cells are
repaired.
"""

LOWEST = """The paper claims that MeshONet's loss is below that of its four modified baselines by orders of magnitude.
Here all models see the same shapes equally often, with the same schedule. Values are mean and spread over the seeds.

"""

QUALITY = """
## Quality, case by case

Each case has 36 shapes of 101 x 101 nodes: 30 for training and 6 for tests, as in the paper. *Interpolation* tests the
middle of the range and trains on both ends. *Extrapolation* tests one end. *Random* tests random positions. All figures
are of test grids, compared with the converged Winslow solution. *Boundary error* is the largest distance of a boundary
node from its place before pasting. Angles are in degrees.

The PDE rows are the grids from which the models learn. On the wrench, Winslow's equations fold 4 to 18 cells of each
grid at the two corners of 270 degrees, and these are repaired. `meshonet-hard` has a trained trunk, and on wrench and
airfoil modes of the training grids ([why](../../theory/paper-models.md#meshonet-hard)).
"""

PAPER = {
    "arch": "The paper claims quality above TFI and PDE, interpolated and extrapolated.",
    "hexagon": "The paper claims quality above TFI and PDE, interpolated and extrapolated.",
    "wrench": "The paper claims quality equal to TFI and above PDE; extrapolated, slightly below TFI.",
    "semicircle": "The paper (random positions) says that quality is not always above the traditional methods.",
    "airfoil": "The paper claims quality equal to PDE and above TFI; extrapolated, slightly below PDE.",
    "hole": "The paper (random positions) claims quality above the traditional methods.",
}

RACE = """
## Loss on one budget

All models see the same shapes equally often, with the same schedule and the same random points in each step. Values are
mean ± spread over the seeds. The paper reports, in a figure over 100,000 iterations, that MeshONet's loss is lowest by
orders of magnitude. The loss of `meshonet-hard` is relative to the correction that it learns and cannot be compared; its
error can. `fno2d` learns from every second node in each direction, because the full square takes four times as long; its
output is interpolated to 101 x 101 nodes by splines.
"""

PHYSICS = """
## Physics-informed networks

Each geometry needs its own network (5,122 parameters), so its training time is its generation time. This one learns the
arch of the refinement table at 101 x 101 nodes. Its output is compared with the converged Winslow solution. The paper
gives no figures for these networks; it calls them as good as the PDE solver, and not general.
"""

TIME = """
## Mesh refinement

Seconds from boundary nodes in memory to grid nodes in memory. The shape is an arch that no model was trained on; one
thread on {machine}. The paper's MeshONet ran on an RTX 4090. The paper's
speed-up of four orders of magnitude is over a PDE solver that takes 140 s for 100 x 100 nodes. Over a multigrid solver
there is no such speed-up.
"""

MAPS = """
## Maps of the largest included angle

The first test shape of each case.
"""

SETTINGS = """
## Training

Adam with a rate of 0.001, multiplied by 0.9 every fifteenth of the epochs (for `meshonet-hard` on wrenches: 0.003 with a
cosine schedule). A step has 30 shapes and 1000 random points inside and 200 on the boundary (a quarter of that for the
modes of `meshonet-hard`). The weights of the loss are 900 and 1000 (`meshonet`). The budget of each run:
"""

SECONDS = {
    "TFI": {100: "0.087", 200: "0.218", 400: "0.928", 800: "3.817", 1600: "15.238", 3200: "72.121"},
    "PDE": {100: "140.331", 200: "586.170", 400: "2360.705", 800: "9795.884"},
    "MeshONet": {100: "0.001", 200: "0.002", 400: "0.002", 800: "0.006", 1600: "0.026", 3200: "0.278"},
}

TIMED = {
    "tfi": "TFI (`tfi`)",
    "pde": "PDE (`solve-pde`, multigrid)",
    "coarse": "PDE on 65 x 65, splined (`solve-pde --coarse 65`)",
    "meshonet": "MeshONet (`infer`)",
    "meshonet-hard": "MeshONet-hard (`infer`)",
}
