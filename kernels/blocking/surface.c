#include "surface.h"

#include <stdlib.h>

static ptrdiff_t next_of(ptrdiff_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static ptrdiff_t previous_of(ptrdiff_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

ptrdiff_t surface_fans(const Surface *s, ptrdiff_t *start, ptrdiff_t *fan)
{
    const ptrdiff_t corners = 3 * s->triangles;
    ptrdiff_t done = 0;
    for (ptrdiff_t v = 0; v < s->vertices; v++)
        start[v] = -1;
    for (ptrdiff_t c = 0; c < corners; c++)
        if (start[s->vertex[c]] < 0 || s->neighbour[c] < 0)
            start[s->vertex[c]] = c;
    for (ptrdiff_t v = 0; v < s->vertices; v++) {
        const ptrdiff_t first = start[v];
        start[v] = done;
        for (ptrdiff_t c = first; c >= 0 && done < corners;) {
            const ptrdiff_t e = previous_of(c);
            fan[done++] = c;
            if (s->neighbour[e] < 0)
                break;
            c = 3 * s->neighbour[e] + s->across[e];
            if (c == first)
                break;
        }
    }
    start[s->vertices] = done;
    return done;
}

ptrdiff_t surface_comb(const Surface *s, const ptrdiff_t *quarters, ptrdiff_t *turn, unsigned char *cut)
{
    ptrdiff_t *queue = calloc((size_t)s->triangles + 1, sizeof *queue + 1), end = 0;
    if (!queue)
        return -1;
    unsigned char *seen = (unsigned char *)(queue + s->triangles + 1);
    for (ptrdiff_t c = 0; c < 3 * s->triangles; c++)
        cut[c] = s->neighbour[c] >= 0;
    turn[0] = 0;
    seen[0] = 1;
    queue[end++] = 0;
    for (ptrdiff_t k = 0; k < end; k++)
        for (ptrdiff_t f = queue[k], c = 3 * f; c < 3 * f + 3; c++) {
            const ptrdiff_t g = s->neighbour[c];
            if (g < 0 || seen[g])
                continue;
            seen[g] = 1;
            turn[g] = turn[f] + quarters[c];
            cut[c] = cut[3 * g + s->across[c]] = 0;
            queue[end++] = g;
        }
    free(queue);
    return end;
}

/* The one edge of the cut that leaves a vertex. */
static ptrdiff_t cut_edge(const ptrdiff_t *fan, ptrdiff_t from, ptrdiff_t to, const unsigned char *cut)
{
    for (ptrdiff_t k = from; k < to; k++)
        if (cut[fan[k]])
            return fan[k];
    return -1;
}

int surface_prune(const Surface *s, const ptrdiff_t *start, const ptrdiff_t *fan, const unsigned char *keep,
                  unsigned char *cut)
{
    ptrdiff_t *degree = calloc((size_t)s->vertices + 1, 2 * sizeof *degree), top = 0;
    if (!degree)
        return -1;
    ptrdiff_t *stack = degree + s->vertices + 1;
    for (ptrdiff_t c = 0; c < 3 * s->triangles; c++)
        degree[s->vertex[c]] += cut[c]; /* of the two halves of an edge one starts at either end */
    for (ptrdiff_t v = 0; v < s->vertices; v++)
        if (degree[v] == 1 && !keep[v])
            stack[top++] = v;
    while (top > 0) {
        const ptrdiff_t v = stack[--top], c = cut_edge(fan, start[v], start[v + 1], cut);
        if (c < 0)
            continue;
        const ptrdiff_t other = s->vertex[next_of(c)];
        cut[c] = cut[3 * s->neighbour[c] + s->across[c]] = 0;
        degree[v] = 0;
        if (--degree[other] == 1 && !keep[other])
            stack[top++] = other;
    }
    free(degree);
    return 0;
}
