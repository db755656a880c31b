"""Binding of picard_kernel.c: Picard's iteration in the strip."""

from libc.stdlib cimport free, malloc


cdef extern from "picard_kernel.h":
    int PICARD_MODES, PICARD_COUNT, PICARD_LEVELS, PICARD_COLUMNS

    ctypedef double *PicardRow "PicardRow *"

    ctypedef struct PicardMatrices:
        PicardRow d1, d2, inverse, vectors
        const double *eigenvalues
        const double *smooth

    ctypedef struct PicardScratch:
        pass

    double picard_step(PicardRow c, double height, const PicardMatrices *m, PicardScratch *s) noexcept nogil


def step(double[:, :, ::1] c, double height, const double[:, :, ::1] matrices, const double[::1] eigenvalues,
         const double[::1] smooth):
    """Take one step on modes `c` (2, 2 MODES + 1, LEVELS), real and imaginary parts; return the largest change.

    Parameters
    ----------
    height : of the strip.
    matrices : (4, LEVELS, LEVELS) transposed: first and second derivative, inverse of the eigenvectors of the
        latter between the walls, the eigenvectors; zero in the walls' rows and columns.
    eigenvalues : (LEVELS,) theirs, anything but zero for the walls.
    smooth : (2 MODES + 1,) what an update's modes are multiplied by.
    """
    cdef PicardMatrices m
    cdef PicardScratch *scratch
    cdef double change
    if c.shape[0] != 2 or c.shape[1] != PICARD_COUNT or c.shape[2] != PICARD_LEVELS:
        raise ValueError("modes and levels are not the kernel's")
    if matrices.shape[0] != 4 or matrices.shape[1] != PICARD_LEVELS or matrices.shape[2] != PICARD_LEVELS:
        raise ValueError("matrices do not fit")
    if eigenvalues.shape[0] != PICARD_LEVELS or smooth.shape[0] != PICARD_COUNT:
        raise ValueError("eigenvalues or smoothing do not fit")
    m.d1, m.d2 = <PicardRow>&matrices[0, 0, 0], <PicardRow>&matrices[1, 0, 0]
    m.inverse, m.vectors = <PicardRow>&matrices[2, 0, 0], <PicardRow>&matrices[3, 0, 0]
    m.eigenvalues, m.smooth = &eigenvalues[0], &smooth[0]
    scratch = <PicardScratch *>malloc(sizeof(PicardScratch))
    if scratch == NULL:
        raise MemoryError
    try:
        with nogil:
            change = picard_step(<PicardRow>&c[0, 0, 0], height, &m, scratch)
    finally:
        free(scratch)
    return change
