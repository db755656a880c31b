cdef extern from "deformation/blend.h":
    ctypedef struct BlendSources:
        ptrdiff_t n
        int axes
        const double *place
        const double *area
        const double *motion
        double near2
    void c_blend_motions "blend_motions"(const BlendSources *sources, const double *x, ptrdiff_t m, int threads,
                                        double *moved) nogil
    void c_blend_transposed "blend_transposed"(const BlendSources *sources, const double *x, const double *pull,
                                               ptrdiff_t m, double *weight, double *gathered) nogil


cdef BlendSources blend_sources(places, areas, double near) except *:
    """Return the sources at places (d, n) with areas (n,); their motions are not set."""
    cdef BlendSources sources
    sources.axes, sources.n, sources.near2 = places.shape[0], places.shape[1], near * near
    if sources.axes not in (2, 3):
        raise ValueError(f"places of shape {places.shape}")
    sources.place = reads(places, (sources.axes, sources.n))
    sources.area = reads(areas, (sources.n,))
    sources.motion = NULL
    return sources


def blend_motions(places, areas, motions, double near, points, int threads, moved):
    """Fill moved (d, m) with means, weighted by distance, of motions (d + d², n) of places (d, n) at points (d, m)."""
    cdef BlendSources sources = blend_sources(places, areas, near)
    cdef ptrdiff_t m = points.shape[1]
    sources.motion = reads(motions, (sources.axes * (sources.axes + 1), sources.n))
    cdef Read x = reads(points, (sources.axes, m))
    cdef Written to = fills(moved, (sources.axes, m))
    with nogil:
        c_blend_motions(&sources, x, m, threads, to)


def blend_transposed(places, areas, double near, points, pull, gathered):
    """Fill gathered (6, n) with the transpose of planar `blend_motions`, applied to pull (2, m) at points (2, m)."""
    cdef BlendSources sources = blend_sources(places, areas, near)
    cdef ptrdiff_t m = points.shape[1]
    cdef Read x = reads(points, (2, m)), force = reads(pull, (2, m))
    if sources.axes != 2:
        raise ValueError("places in space")
    cdef Written to = fills(gathered, (6, sources.n))
    room = np.empty(sources.n)
    cdef Written weight = fills(room, (sources.n,))
    with nogil:
        c_blend_transposed(&sources, x, force, m, weight, to)
