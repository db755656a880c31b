"""Values between the nodes of tables: polynomials of degree three are met, others to the fourth order."""

import numpy as np
import pytest

from meshonet.kernels._native import lattice_values


def between(table, u, v):
    out = np.empty((len(u), table.shape[2]))
    lattice_values(table, u, v, out)
    return out


def test_cubics_are_met_in_the_table_and_beyond_it():
    u, v = (np.random.default_rng(k).uniform(-0.5, 7.5, 50) for k in (0, 1))
    x, y = np.meshgrid(np.arange(9.0), np.arange(8.0), indexing="ij")
    table = np.stack([x**3 - 2 * x * y**3, x**2 * y**2 + 1], axis=-1)
    expected = np.stack([u**3 - 2 * u * v**3, u**2 * v**2 + 1], axis=-1)
    np.testing.assert_allclose(between(table, u, v), expected, atol=1e-9)


def test_the_error_falls_with_the_fourth_power_of_the_step():
    place = np.random.default_rng(2).uniform(0.1, 0.9, 200)
    errors = []
    for n in (21, 41):
        line = np.sin(3.0 * np.linspace(0.0, 1.0, n))
        error = between(line[:, None, None], place * (n - 1), place)[:, 0] - np.sin(3.0 * place)
        errors.append(np.abs(error).max())
    assert errors[0] / errors[1] > 12.0


def test_tables_of_too_few_nodes_are_refused():
    with pytest.raises(ValueError, match="too few"):
        between(np.zeros((3, 5, 1)), np.zeros(1), np.zeros(1))
