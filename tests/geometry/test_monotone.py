import numpy as np

from meshonet.geometry.curves.monotone import monotone_cubic


def test_monotone_cubic_is_monotone_and_exact_at_its_points():
    rng = np.random.default_rng(0)
    x, y = np.cumsum(rng.random(20)), np.cumsum(rng.random(20) ** 4)
    at = np.linspace(x[0], x[-1], 2000)
    assert (np.diff(monotone_cubic(x, y, at)) >= 0).all()
    np.testing.assert_allclose(monotone_cubic(x, y, x), y, atol=1e-14)


def test_monotone_cubic_is_of_high_order_on_smooth_data():
    def error(n: int) -> float:
        x = np.linspace(0, 1, n)
        at = np.linspace(0, 1, 999)
        return float(np.abs(monotone_cubic(x, np.exp(x), at) - np.exp(at)).max())

    assert error(20) / error(40) > 3.5
