/* A triangulation of points inside a box, with neighbours: points inserted, edges flipped. */
#ifndef MESHONET_TRIANGULATION_MESH_H
#define MESHONET_TRIANGULATION_MESH_H

#include "exact.h"
#include <stddef.h>

enum { BOX = 4, SIDE_BITS = 30, OUT_OF_MEMORY = -1, SAME_PLACE = -2, BLOCKED = -3 };

/* Corners counter-clockwise; edge i is opposite corner i, as is the triangle beside it (-1: none). */
typedef struct {
    int32_t corner[3], beside[3];
    uint8_t wall[3]; /* an edge that is never flipped nor crossed */
    uint8_t inside;
    uint32_t stamp; /* counts the changes */
    uint32_t seen;  /* number of the last search that came by */
} Triangle;

typedef struct {
    ptrdiff_t n, node_room, m, triangle_room, depth, stack_room;
    Node *node; /* the first four are the corners of the box */
    double *size; /* wanted length of edges */
    int32_t *at;  /* a triangle at each node */
    Triangle *triangle;
    int32_t *stack; /* pairs: a triangle, and an edge of it to look at */
    int32_t last;   /* triangle where the next search starts */
    uint32_t chance, searches;
    int32_t *changed; /* triangles that an insertion made or changed */
    ptrdiff_t n_changed, changed_room;
} Mesh;

/* The edge of u that triangle t is beside. */
static inline int edge_to(const Triangle *u, int32_t t)
{
    return u->beside[0] == t ? 0 : u->beside[1] == t ? 1 : 2;
}

int mesh_start(Mesh *mesh, ptrdiff_t nodes);
void mesh_free(Mesh *mesh);

/* Note triangle t for a search. */
int mesh_push(Mesh *mesh, int32_t t, int edge);

/* Make room for `nodes` nodes in all. */
int mesh_reserve(Mesh *mesh, ptrdiff_t nodes);

/* Triangle that contains p, or BLOCKED where a wall is before it. */
int32_t mesh_find(Mesh *mesh, Node p, int32_t from);

/* Put node v, whose place is set, into a triangle that contains it; legal edges follow. */
int mesh_insert(Mesh *mesh, int32_t v, int32_t t);

/* Flip edges that are not walls until each is locally Delaunay. */
int mesh_flip_all(Mesh *mesh);

/* The triangle to the left of the edge from a to b, its number in `edge`; -1 where there is none. */
int32_t mesh_edge(const Mesh *mesh, int32_t a, int32_t b, int *edge);

/* Flip edges until a b is one. 0 when done, 1 when the wall between two nodes, or a node (twice), is in the `way`. */
int mesh_force(Mesh *mesh, int32_t a, int32_t b, int32_t way[2]);

/* Mark or clear the walls a[k] b[k], which are edges, on both sides. */
void mesh_walls(Mesh *mesh, const int32_t *pairs, ptrdiff_t count, int wall);

/* Mark the triangles to the left of the walls, as far as the next walls. */
int mesh_inside(Mesh *mesh, const int32_t *pairs, ptrdiff_t count);

#endif
