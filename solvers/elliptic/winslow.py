"""Winslow's equations in terms of derivatives: Winslow, J. Comput. Phys. 1 (1966) 149-172."""

from collections.abc import Callable
from typing import Any


def left_side(derivatives: Any, dot: Callable[[Any, Any], Any]) -> tuple[Any, Any, Any]:
    """Return α x_ξξ - 2β x_ξη + γ x_ηη, α and γ, where α = x_η·x_η, β = x_ξ·x_η and γ = x_ξ·x_ξ.

    `derivatives` are x_ξ, x_η, x_ξξ, x_ξη and x_ηη, arrays of numpy or torch. `dot` returns scalar products
    of such arrays, in a shape that can be multiplied with them.
    """
    xi, eta, bend, twist, rise = derivatives
    alpha, beta, gamma = dot(eta, eta), dot(xi, eta), dot(xi, xi)
    return alpha * bend - 2.0 * beta * twist + gamma * rise, alpha, gamma
