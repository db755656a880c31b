"""The variational functional: variational grids, repair of folded cells, untangling."""
