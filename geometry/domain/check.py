"""stub"""
from meshonet.geometry.domain.domain import Domain


def check_domain(domain: Domain) -> None:
    """Stub."""
