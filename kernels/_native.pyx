"""The compiled functions, in a file for each subject; the C sources next to it say what they compute."""

import numpy as np

from libc.stddef cimport ptrdiff_t
from libc.stdint cimport int32_t, int64_t, uint8_t, uint64_t, uintptr_t
from libc.stdlib cimport calloc, free, malloc

include "include/arrays.pxi"
include "include/complex.pxi"
include "elementary/elementary.pxi"
include "geometry/geometry.pxi"
include "algebraic/algebraic.pxi"
include "elliptic/elliptic.pxi"
include "energy/energy.pxi"
include "hyperbolic/hyperbolic.pxi"
include "layers/layers.pxi"
include "conformal/conformal.pxi"
include "rows/rows.pxi"
include "neural/neural.pxi"
include "formats/formats.pxi"
include "triangulation/triangulation.pxi"
include "motorcycle/motorcycle.pxi"
include "sparse/sparse.pxi"
include "blocking/blocking.pxi"
include "quads/quads.pxi"
include "collapse/collapse.pxi"
include "volumes/volumes.pxi"
include "surfaces/surfaces.pxi"
include "solids/solids.pxi"
include "hexes/hexes.pxi"
include "deformation/deformation.pxi"
