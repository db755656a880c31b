"""A cross field on a surface of triangles, and the seamless map that follows it."""
