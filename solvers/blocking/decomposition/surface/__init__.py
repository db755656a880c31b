"""The triangles of a domain, and equations on them."""
