"""What the pages of docs/paper say around their tables, and the paper's own figures."""

HEAD = """
# The MeshONet paper, done again

<!-- made by make paper -->

Xiao, Chen, Peng, Wang, Liu, *MeshONet: A Generalizable and Efficient Operator Learning Method for Structured Mesh
Generation*, arXiv 2501.11937. Every figure here comes from `meshonet` commands: `make paper` samples the six
families, solves, trains, infers and judges; `examples/paper/Makefile` is the recipe. The models are described in
[paper-models.md](../paper-models.md). The paper's quality figure is the largest included angle, shown as colour maps;
it gives no numbers for it, so what it *claims* stands beside what we measure.
"""

STANDS = """
## What stands and what falls
"""

CLAIMS = """
**Quality**: the largest included angle of MeshONet's grids (the paper's way: true walls pasted over the answer), mean over the test
grids, against the classical ways; lower is better. Pasting puts the true wall over a row of nodes that is off by the
error of the network's own boundary, and folds the cells between wherever that error exceeds the first row's height;
`meshonet-hard` has nothing to paste. *Delivered* is what `infer` gives unless told otherwise: the same answer, its
folded cells repaired by the guard that every command has.
"""

LOWEST = """The paper claims that MeshONet's loss is below that of its four modified baselines by orders of magnitude.
Here every model has the same shapes, as often, with the same schedule; mean and spread over the seeds.

"""

QUALITY = """
## Quality, case by case

36 shapes of 101 x 101 nodes a case: 30 trained on, 6 kept for tests (the paper's counts). Interpolation tests the
middle of the range and trains on both ends, extrapolation tests one end, random tests random positions. Everything
is measured on test grids only, against the converged Winslow solution. *Boundary off by* is the largest distance of
a boundary node from its place before anything is pasted. Angles in degrees. The PDE rows are the grids the models
learn from, repaired where Winslow's equations fold them: the wrench, 4 to 18 cells a grid at the two corners of 270
degrees, more on finer ones. `meshonet-hard` has a trained trunk, on wrench and airfoil modes of the training
grids ([why](../paper-models.md#meshonet-hard)).
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
## Loss, on one budget

Every model sees the same shapes as often, with the same schedule and the same places drawn for each step; mean ± spread
over the seeds. The paper reports (a figure, 100,000 iterations) that MeshONet's loss is lowest by orders of magnitude.
The loss of `meshonet-hard` is of the difference from its base, relative to it, and cannot be compared; its error can.
`fno2d` learns from every second node of either direction (51 x 51), since the whole square takes it four times as
long; its answers are splined to 101 x 101 and judged there.
"""

PHYSICS = """
## Physics-informed networks

One network for each geometry (5,122 parameters), so this one learns the arch of the refinement table, 101 x 101 nodes,
and answers no other; its training is its generation time. As it answers, against the converged Winslow solution.
The paper gives no figures for this line; it calls it as good as the PDE solver in quality and not general.
"""

TIME = """
## Mesh refinement

Seconds from boundary nodes in memory to grid nodes in memory, one arch that no model was trained on, one thread on
{machine}. The paper's MeshONet ran on an RTX 4090. The paper's factor of four orders of magnitude is against a
PDE solver that takes 140 s for 100 x 100 nodes; against a multigrid solver it does not hold.
"""

MAPS = """
## Maps of the largest included angle

The first test shape of each case.
"""

SETTINGS = """
## Training

Adam, rate 0.001 times 0.9 every fifteenth of the epochs (0.003 falling as a cosine for `meshonet-hard` on wrenches); 30
shapes a step; 1000 places inside and 200 on the boundary drawn for each step (a quarter of that for the modes of
`meshonet-hard`); weights 900 and 1000 (`meshonet`). What each run was given:
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
