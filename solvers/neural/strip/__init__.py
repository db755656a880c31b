"""The airfoil operator: a network that corrects the harmonic base in the periodic strip."""
