"""The kernel that evens steps along a curve finds the places that NumPy finds with whole matrices."""

import numpy as np
import pytest

from meshonet.solvers.layers.even_line import (
    MARGIN,
    MOVE,
    NO_LINKS,
    STEPS,
    Measures,
    PlaceLinks,
    evened_places,
)
from meshonet.solvers.layers.growth_limit import EXCESS, HALVINGS, MOST_WEIGHT, RISE, GrowthLimit

LIMIT, CHANGE = np.log(1.15), 0.7


def steps_of(places, measures, closed):
    """Steps (k, s) of each measure, and derivatives (k, s, n) of these by the places."""
    length, n = measures.arcs[-1], len(places)
    ends = np.append(places, places[0] + length) if closed else places
    turns, rest = np.divmod(ends, length) if closed else (np.zeros(len(ends)), ends)
    interval = np.clip(np.searchsorted(measures.arcs, rest, "right") - 1, 0, len(measures.arcs) - 2)
    rise = (np.diff(measures.values) / np.diff(measures.arcs))[:, interval]
    values = measures.values[:, interval] + rise * (rest - measures.arcs[interval])
    values += turns * (measures.values[:, -1:] - measures.values[:, :1])
    by = rise[:, :, None] * np.eye(n)[np.arange(len(ends)) % n]
    return np.diff(values), np.diff(by, axis=1)


def logs_of(places, measures, closed):
    """Logarithms (k, r) of the ratios of neighbouring steps, and their derivatives (k, r, n)."""
    steps, by = steps_of(places, measures, closed)
    logs, by = np.log(steps), by / steps[..., None]
    if closed:
        logs, by = np.append(logs, logs[:, :1], axis=1), np.append(by, by[:, :1], axis=1)
    return np.diff(logs), np.diff(by, axis=1)


def stiffness_of(places, measures, closed):
    ends = [places[-1] - measures.arcs[-1]], places, [places[0] + measures.arcs[-1]]
    if not closed:
        ends = [2 * places[0] - places[1]], places, [2 * places[-1] - places[-2]]
    step = np.diff(np.concatenate(ends))
    return MOVE / (step[1:] * step[:-1])


def evened_by_numpy(given, fixed, measures, closed, links):
    limits = LIMIT * np.asarray(measures.slack) * np.ones(len(measures.values))
    strict, stiffness = limits[:, None] - MARGIN, stiffness_of(given, measures, closed)
    term = GrowthLimit.at(logs_of(given, measures, closed)[0], strict, CHANGE)
    joined = np.zeros((len(links.pairs), len(given)))
    for k in (0, 1):
        np.add.at(joined, (np.arange(len(links.pairs)), links.pairs[:, k]), links.factors[:, k])

    def value(places, weight):
        if (steps_of(places, measures, closed)[0] <= 0.0).any():
            return np.inf
        own = term.values(logs_of(places, measures, closed)[0], weight).sum()
        return own + (stiffness * (places - given) ** 2)[~fixed].sum() + (links.values(places) ** 2).sum()

    places, weight = given, EXCESS
    for _ in range(STEPS):
        weight = min(weight * RISE, MOST_WEIGHT)
        each = term.residuals(*logs_of(places, measures, closed), weight)
        by, stiff, pull = each.derivatives.reshape(-1, len(given)), each.weight.ravel(), each.slope.ravel()
        matrix = (by.T * stiff) @ by + np.diag(stiffness) + joined.T @ joined
        slope = by.T @ pull + stiffness * (places - given) + joined.T @ links.values(places)
        step = np.zeros(len(given))
        step[~fixed] = np.linalg.solve(matrix[np.ix_(~fixed, ~fixed)], -slope[~fixed])
        before = value(places, weight)
        tried = (places + 0.5**k * step for k in range(HALVINGS))
        places = next((each for each in tried if value(each, weight) < before), places)
        if (np.abs(logs_of(places, measures, closed)[0]) <= limits[:, None]).all():
            break
    return places


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("closed", [False, True])
def test_places_are_those_of_numpy(closed: bool, linked: bool) -> None:
    rng = np.random.default_rng(5)
    arcs = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, 60))])
    values = np.stack([arcs, np.cumsum(np.append(0.0, np.diff(arcs) * (1.2 + np.sin(arcs[1:] / 9.0))))])
    measures = Measures(arcs, values, np.array([1.0, 1.4]))
    places = np.cumsum(rng.uniform(0.8, 1.6, 40))
    places *= 0.97 * arcs[-1] / places[-1]
    fixed = np.isin(np.arange(40), [0, 17, 39])
    links = NO_LINKS
    if linked:
        pairs = np.stack([np.arange(3, 15), np.arange(36, 24, -1)], axis=1)
        links = PlaceLinks(pairs, np.full((12, 2), 0.2), -0.2 * (places[pairs].sum(axis=1) + 0.3))
    made = evened_places(places, fixed, measures, LIMIT, closed, links, most=np.inf, change=CHANGE)
    expected = evened_by_numpy(places, fixed, measures, closed, links)
    assert np.abs(made - places).max() > 0.1
    assert made == pytest.approx(expected, abs=1e-9)
    assert (made[fixed] == places[fixed]).all()
