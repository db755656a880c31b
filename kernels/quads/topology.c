/* The neighbours of edges of quads along grid lines. */
#include "topology.h"
#include <stdlib.h>
#include <string.h>

typedef struct {
    ptrdiff_t *line, *filled, pairs;
} Lines;

static void pair_up(Lines *l, ptrdiff_t a, ptrdiff_t b)
{
    if (a == b || l->filled[a] == NEXT_EDGES || l->filled[b] == NEXT_EDGES)
        return;
    l->line[a * NEXT_EDGES + l->filled[a]++] = b;
    l->line[b * NEXT_EDGES + l->filled[b]++] = a;
    l->pairs++;
}

/* The edges (4, 2) that leave and enter a node in its four quads: those that share no quad go straight on. */
static void straight_on(Lines *l, const ptrdiff_t (*both)[2])
{
    ptrdiff_t distinct[4], count = 0, beside[4] = {0};
    for (int k = 0; k < 8; k++) {
        const ptrdiff_t edge = both[k / 2][k % 2];
        ptrdiff_t i = 0;
        while (i < count && distinct[i] != edge)
            i++;
        if (i == count) {
            if (count == 4)
                return;
            distinct[count++] = edge;
        }
    }
    if (count != 4)
        return;
    for (int k = 0; k < 4; k++)
        for (int i = 1; i < 4; i++)
            if ((both[k][0] == distinct[0] && both[k][1] == distinct[i]) ||
                (both[k][1] == distinct[0] && both[k][0] == distinct[i]))
                beside[i] = 1;
    for (int i = 1; i < 4; i++)
        if (!beside[i]) {
            pair_up(l, distinct[0], distinct[i]);
            pair_up(l, distinct[i == 1 ? 2 : 1], distinct[i == 3 ? 2 : 3]);
            return;
        }
}

ptrdiff_t line_neighbours(const ptrdiff_t *quads, const ptrdiff_t *edge_of, ptrdiff_t m, ptrdiff_t n, ptrdiff_t e,
                          const ptrdiff_t *node, const ptrdiff_t *edge, ptrdiff_t *line, ptrdiff_t *room)
{
    ptrdiff_t *start = room, *rim = room + n + 1, *corner = rim + n, *filled = corner + 4 * m, *sides = filled + e;
    Lines lines = {line, filled, 0};
    memset(start, 0, (size_t)(2 * n + 1) * sizeof *start);
    memset(filled, 0, (size_t)(2 * e) * sizeof *filled);
    for (ptrdiff_t k = 0; k < e; k++)
        for (int i = 0; i < NEXT_EDGES; i++)
            line[k * NEXT_EDGES + i] = k;
    for (ptrdiff_t k = 0; k < 4 * m; k++)
        start[node[quads[k]] + 1]++, sides[edge[edge_of[k]]]++;
    for (ptrdiff_t v = 0; v < n; v++)
        start[v + 1] += start[v];
    for (ptrdiff_t k = 0; k < 4 * m; k++) {
        const ptrdiff_t a = node[quads[k]], b = node[quads[k % 4 == 3 ? k - 3 : k + 1]];
        corner[start[a]++] = k;
        if (sides[edge[edge_of[k]]] == 1)
            rim[a] = rim[b] = 1;
    }
    for (ptrdiff_t q = 0; q < m; q++)
        for (int i = 0; i < 2; i++)
            pair_up(&lines, edge[edge_of[4 * q + i]], edge[edge_of[4 * q + i + 2]]);
    for (ptrdiff_t k = 0; k < e; k++)
        filled[k] = FIRST_BEHIND;
    for (ptrdiff_t v = 0, first = 0; v < n; v++) {
        const ptrdiff_t count = start[v] - first, *at = corner + first;
        ptrdiff_t both[4][2];
        first = start[v];
        if (count != (rim[v] ? 2 : 4))
            continue;
        for (ptrdiff_t k = 0; k < count; k++) {
            both[k][0] = edge[edge_of[at[k]]];
            both[k][1] = edge[edge_of[at[k] % 4 == 0 ? at[k] + 3 : at[k] - 1]];
        }
        if (!rim[v]) {
            straight_on(&lines, (const ptrdiff_t(*)[2])both);
            continue;
        }
        ptrdiff_t ends[4], wall = 0;
        for (int k = 0; k < 4; k++)
            if (sides[both[k / 2][k % 2]] == 1)
                ends[wall++] = both[k / 2][k % 2];
        if (wall == 2)
            pair_up(&lines, ends[0], ends[1]);
    }
    return lines.pairs;
}

static int by_number(const void *a, const void *b)
{
    const ptrdiff_t one = *(const ptrdiff_t *)a, other = *(const ptrdiff_t *)b;
    return (one > other) - (one < other);
}

int quad_images(const ptrdiff_t *twin, ptrdiff_t m, ptrdiff_t quad, ptrdiff_t image, ptrdiff_t corner,
                ptrdiff_t *images, ptrdiff_t *first, ptrdiff_t *room)
{
    ptrdiff_t *front = room, *next = room + m, *reached = room + 2 * m, count = 1;
    for (ptrdiff_t q = 0; q < m; q++)
        images[q] = reached[q] = -1, first[q] = 0;
    images[quad] = image, first[quad] = corner, front[0] = quad;
    for (ptrdiff_t round = 0; count > 0; round++) {
        ptrdiff_t found = 0;
        for (ptrdiff_t i = 0; i < count; i++)
            for (ptrdiff_t side = 0; side < 4; side++) {
                const ptrdiff_t q = front[i], across = twin[4 * q + side];
                const ptrdiff_t beyond = twin[4 * images[q] + (first[q] - side + 7) % 4];
                if ((across < 0) != (beyond < 0))
                    return 0;
                if (across < 0 || (images[across / 4] >= 0 && reached[across / 4] != round))
                    continue;
                if (reached[across / 4] != round)
                    next[found++] = across / 4;
                reached[across / 4] = round;
                images[across / 4] = beyond / 4, first[across / 4] = (across + beyond + 1) % 4;
            }
        qsort(next, (size_t)found, sizeof *next, by_number);
        ptrdiff_t *const swap = front;
        front = next, next = swap, count = found;
    }
    return 1;
}
