"""One corner energy: variational grids, repair of folded cells, untangling."""
