"""Architectures in torch, one a file; nothing outside training imports them."""
