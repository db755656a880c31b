/* Faces between the cells of blocks; see faces.c. */
#pragma once
#include <stddef.h>
#include <stdint.h>

/* A block of ni x nj x nk cells, the first of which has the number `first`, i fastest. `nodes` are the numbers of its
   (ni+1) x (nj+1) x (nk+1) nodes; `beyond` are, at the sides west, east, south, north, bottom and top, the number of the
   cell beyond each face, negative at the boundary: (nk, nj), (nk, ni) or (nj, ni) of them, the last index fastest. */
typedef struct {
    const int32_t *nodes, *beyond[6];
    ptrdiff_t ni, nj, nk;
    int32_t first;
} cell_block;

/* Where faces go: four nodes, the cell behind and the cell before each; there is room for so many. */
typedef struct {
    int32_t *nodes, *owner, *neighbour;
    ptrdiff_t room;
} face_lists;

/* Write the faces whose owner is a cell of the block, in upper-triangular order; return how many, or -1 without room. */
ptrdiff_t inner_faces(const cell_block *block, face_lists out);
