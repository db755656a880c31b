# Grids from six faces: transfinite, elliptic, variational.
