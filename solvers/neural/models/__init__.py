"""Models, one a file.

Those of `meshonet.solvers.neural.registry` are written once for numpy and torch; `strip_fno` is in torch, its twin in
numpy is `meshonet.solvers.neural.network`.
"""
