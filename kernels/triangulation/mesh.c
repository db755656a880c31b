/* Incremental Delaunay triangulation by flips (Lawson 1977), found by walking (Devillers, Pion, Teillaud 2002). */
#include "mesh.h"
#include <stdlib.h>

static const int NEXT[3] = {1, 2, 0}, AFTER[3] = {2, 0, 1};

static int grow(void **array, ptrdiff_t *room, ptrdiff_t need, size_t size)
{
    if (need <= *room)
        return 0;
    const ptrdiff_t wanted = need > 2 * *room ? need : 2 * *room;
    void *more = realloc(*array, (size_t)wanted * size);
    if (!more)
        return OUT_OF_MEMORY;
    *array = more, *room = wanted;
    return 0;
}

int mesh_reserve(Mesh *mesh, ptrdiff_t nodes)
{
    ptrdiff_t room = mesh->node_room, rooms = mesh->node_room;
    if (grow((void **)&mesh->node, &room, nodes, sizeof(Node)) ||
        grow((void **)&mesh->size, &rooms, nodes, sizeof(double)) ||
        grow((void **)&mesh->at, &mesh->node_room, nodes, sizeof(int32_t)))
        return OUT_OF_MEMORY;
    return grow((void **)&mesh->triangle, &mesh->triangle_room, 2 * mesh->node_room, sizeof(Triangle));
}

int mesh_start(Mesh *mesh, ptrdiff_t nodes)
{
    const int64_t top = ((int64_t)1 << SIDE_BITS) - 1;
    if (mesh_reserve(mesh, nodes + BOX))
        return OUT_OF_MEMORY;
    mesh->node[0] = (Node){0, 0}, mesh->node[1] = (Node){top, 0};
    mesh->node[2] = (Node){top, top}, mesh->node[3] = (Node){0, top};
    mesh->triangle[0] = (Triangle){{0, 1, 2}, {-1, 1, -1}, {0, 0, 0}, 0, 0, 0};
    mesh->triangle[1] = (Triangle){{0, 2, 3}, {-1, -1, 0}, {0, 0, 0}, 0, 0, 0};
    for (int k = 0; k < BOX; k++)
        mesh->at[k] = k == 3, mesh->size[k] = 1e300;
    mesh->n = BOX, mesh->m = 2, mesh->last = 0, mesh->chance = 1, mesh->searches = 0;
    return 0;
}

void mesh_free(Mesh *mesh)
{
    free(mesh->node), free(mesh->size), free(mesh->at), free(mesh->triangle), free(mesh->stack), free(mesh->changed);
}

int mesh_push(Mesh *mesh, int32_t t, int edge)
{
    if (grow((void **)&mesh->stack, &mesh->stack_room, 2 * mesh->depth + 2, sizeof(int32_t)))
        return OUT_OF_MEMORY;
    mesh->stack[2 * mesh->depth] = t, mesh->stack[2 * mesh->depth++ + 1] = edge;
    return 0;
}

static int note(Mesh *mesh, int32_t t)
{
    mesh->triangle[t].stamp++;
    if (grow((void **)&mesh->changed, &mesh->changed_room, mesh->n_changed + 1, sizeof(int32_t)))
        return OUT_OF_MEMORY;
    mesh->changed[mesh->n_changed++] = t;
    return 0;
}

static void relink(Mesh *mesh, int32_t u, int32_t from, int32_t to)
{
    if (u >= 0)
        mesh->triangle[u].beside[edge_to(&mesh->triangle[u], from)] = to;
}

/* Set triangle t: corners, and for edges 0, 1, 2 what is beside and whether it is a wall. */
static void set(Mesh *mesh, int32_t t, int32_t a, int32_t b, int32_t c, const int32_t *beside, const uint8_t *wall)
{
    Triangle *to = &mesh->triangle[t];
    to->corner[0] = a, to->corner[1] = b, to->corner[2] = c;
    for (int k = 0; k < 3; k++)
        to->beside[k] = beside[k], to->wall[k] = wall[k];
    mesh->at[a] = mesh->at[b] = mesh->at[c] = t;
}

/* Flip edge i of t. With p = corner i of t and q opposite: t becomes p a q and the other p q b. */
static void flip(Mesh *mesh, int32_t t, int i)
{
    const Triangle one = mesh->triangle[t];
    const int32_t u = one.beside[i];
    const Triangle two = mesh->triangle[u];
    const int j = edge_to(&two, t), i1 = NEXT[i], i2 = AFTER[i], j1 = NEXT[j], j2 = AFTER[j];
    const int32_t p = one.corner[i], a = one.corner[i1], b = one.corner[i2], q = two.corner[j];
    set(mesh, t, p, a, q, (int32_t[]){two.beside[j1], u, one.beside[i2]},
        (uint8_t[]){two.wall[j1], 0, one.wall[i2]});
    set(mesh, u, p, q, b, (int32_t[]){two.beside[j2], one.beside[i1], t},
        (uint8_t[]){two.wall[j2], one.wall[i1], 0});
    relink(mesh, two.beside[j1], u, t);
    relink(mesh, one.beside[i1], t, u);
}

/* Flip what is on the stack, and what follows from it: `all` edges around a flip, or only those opposite corner 0. */
static int legalise(Mesh *mesh, int all)
{
    while (mesh->depth) {
        mesh->depth--;
        const int32_t t = mesh->stack[2 * mesh->depth];
        const int i = (int)mesh->stack[2 * mesh->depth + 1];
        const Triangle *one = &mesh->triangle[t];
        const int32_t u = one->beside[i];
        if (u < 0 || one->wall[i])
            continue;
        const Triangle *two = &mesh->triangle[u];
        const Node *node = mesh->node;
        if (!in_circle(node[one->corner[0]], node[one->corner[1]], node[one->corner[2]],
                       node[two->corner[edge_to(two, t)]]))
            continue;
        flip(mesh, t, i);
        if (note(mesh, t) || note(mesh, u) || mesh_push(mesh, t, 0) || mesh_push(mesh, u, 0) ||
            (all && (mesh_push(mesh, t, 2) || mesh_push(mesh, u, 1))))
            return OUT_OF_MEMORY;
    }
    return 0;
}

int mesh_flip_all(Mesh *mesh)
{
    mesh->n_changed = 0;
    for (int32_t t = 0; t < mesh->m; t++)
        for (int i = 0; i < 3; i++)
            if (mesh->triangle[t].beside[i] > t && mesh_push(mesh, t, i))
                return OUT_OF_MEMORY;
    return legalise(mesh, 1);
}

int32_t mesh_find(Mesh *mesh, Node p, int32_t from)
{
    int32_t t = from, before = -1;
    for (ptrdiff_t step = 0; step < 4 * mesh->m + 100; step++) {
        const Triangle *here = &mesh->triangle[t];
        mesh->chance = mesh->chance * 1664525u + 1013904223u; /* which edge first: no walk in a circle */
        int i = (int)((mesh->chance >> 16) % 3), k = 0;
        for (; k < 3; k++, i = NEXT[i])
            if (here->beside[i] != before &&
                turn(mesh->node[here->corner[NEXT[i]]], mesh->node[here->corner[AFTER[i]]], p) < 0)
                break;
        if (k == 3)
            return t;
        if (here->wall[i] || here->beside[i] < 0)
            return BLOCKED;
        before = t, t = here->beside[i];
    }
    return BLOCKED;
}

int mesh_insert(Mesh *mesh, int32_t v, int32_t t)
{
    const Triangle old = mesh->triangle[t];
    for (int k = 0; k < 3; k++) {
        const Node corner = mesh->node[old.corner[k]];
        if (corner.x == mesh->node[v].x && corner.y == mesh->node[v].y)
            return SAME_PLACE;
    }
    const int32_t u = (int32_t)mesh->m, w = u + 1, a = old.corner[0], b = old.corner[1], c = old.corner[2];
    mesh->m += 2;
    mesh->triangle[u].stamp = mesh->triangle[w].stamp = 0;
    mesh->triangle[u].seen = mesh->triangle[w].seen = 0;
    mesh->triangle[u].inside = mesh->triangle[w].inside = old.inside;
    set(mesh, t, v, b, c, (int32_t[]){old.beside[0], u, w}, (uint8_t[]){old.wall[0], 0, 0});
    set(mesh, u, v, c, a, (int32_t[]){old.beside[1], w, t}, (uint8_t[]){old.wall[1], 0, 0});
    set(mesh, w, v, a, b, (int32_t[]){old.beside[2], t, u}, (uint8_t[]){old.wall[2], 0, 0});
    relink(mesh, old.beside[1], t, u);
    relink(mesh, old.beside[2], t, w);
    mesh->last = t, mesh->n_changed = 0;
    if (note(mesh, t) || note(mesh, u) || note(mesh, w) || mesh_push(mesh, t, 0) || mesh_push(mesh, u, 0) ||
        mesh_push(mesh, w, 0))
        return OUT_OF_MEMORY;
    return legalise(mesh, 0);
}

int32_t mesh_edge(const Mesh *mesh, int32_t a, int32_t b, int *edge)
{
    const int32_t start = mesh->at[a];
    int32_t t = start;
    do {
        const Triangle *here = &mesh->triangle[t];
        const int k = here->corner[0] == a ? 0 : here->corner[1] == a ? 1 : 2;
        if (here->corner[NEXT[k]] == b) {
            *edge = AFTER[k];
            return t;
        }
        t = here->beside[NEXT[k]]; /* counter-clockwise about a */
    } while (t != start && t >= 0);
    return -1;
}

/* The triangle at a whose opposite edge is crossed on the way to b; -1 where a node or nothing is in the way. */
static int32_t towards(const Mesh *mesh, int32_t a, int32_t b, int *edge)
{
    const int32_t start = mesh->at[a];
    int32_t t = start;
    do {
        const Triangle *here = &mesh->triangle[t];
        const int k = here->corner[0] == a ? 0 : here->corner[1] == a ? 1 : 2;
        const Node from = mesh->node[a], to = mesh->node[b];
        const Node right = mesh->node[here->corner[NEXT[k]]], left = mesh->node[here->corner[AFTER[k]]];
        if (turn(from, to, right) < 0 && turn(from, to, left) > 0) {
            *edge = k;
            return t;
        }
        t = here->beside[NEXT[k]];
    } while (t != start && t >= 0);
    return -1;
}

int mesh_force(Mesh *mesh, int32_t a, int32_t b, int32_t way[2])
{
    int edge;
    for (ptrdiff_t round = 0; round < 1000 + 4 * mesh->m; round++) {
        way[0] = way[1] = -1;
        if (mesh_edge(mesh, a, b, &edge) >= 0)
            return 0;
        int32_t t = towards(mesh, a, b, &edge);
        if (t < 0)
            return 1;
        for (int done = 0; !done;) { /* an edge on the way that can be flipped, mostly the first */
            const Triangle *here = &mesh->triangle[t];
            const int32_t u = here->beside[edge], right = here->corner[NEXT[edge]], left = here->corner[AFTER[edge]];
            way[0] = right, way[1] = left;
            if (u < 0 || here->wall[edge])
                return 1;
            const Triangle *there = &mesh->triangle[u];
            const int j = edge_to(there, t);
            const int32_t p = here->corner[edge], q = there->corner[j];
            const Node *node = mesh->node;
            const int64_t side = turn(node[a], node[b], node[q]);
            way[0] = way[1] = q;
            if (q != b && side == 0)
                return 1;
            mesh->chance = mesh->chance * 1664525u + 1013904223u; /* so that flips do not undo one another for ever */
            if (turn(node[p], node[right], node[q]) > 0 && turn(node[q], node[left], node[p]) > 0 &&
                (q == b || mesh->chance >> 30)) {
                flip(mesh, t, edge);
                done = 1;
            } else if (q == b) {
                done = 1; /* none: again by other chances */
            } else {
                edge = side > 0 ? AFTER[j] : NEXT[j]; /* of the next triangle, what is crossed */
                t = u;
            }
        }
    }
    return 1;
}

void mesh_walls(Mesh *mesh, const int32_t *pairs, ptrdiff_t count, int wall)
{
    for (ptrdiff_t k = 0; k < 2 * count; k++) {
        int edge;
        const int32_t t = mesh_edge(mesh, pairs[k], pairs[k ^ 1], &edge);
        if (t >= 0)
            mesh->triangle[t].wall[edge] = (uint8_t)wall;
    }
}

int mesh_inside(Mesh *mesh, const int32_t *pairs, ptrdiff_t count)
{
    for (int32_t t = 0; t < mesh->m; t++)
        mesh->triangle[t].inside = 0;
    for (ptrdiff_t k = 0; k < count; k++) {
        int edge;
        const int32_t t = mesh_edge(mesh, pairs[2 * k], pairs[2 * k + 1], &edge);
        if (t >= 0 && mesh_push(mesh, t, 0))
            return OUT_OF_MEMORY;
    }
    while (mesh->depth) {
        Triangle *here = &mesh->triangle[mesh->stack[2 * --mesh->depth]];
        if (here->inside)
            continue;
        here->inside = 1;
        for (int i = 0; i < 3; i++)
            if (!here->wall[i] && here->beside[i] >= 0 && mesh_push(mesh, here->beside[i], 0))
                return OUT_OF_MEMORY;
    }
    return 0;
}
