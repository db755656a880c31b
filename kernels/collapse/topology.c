#include "topology.h"

static ptrdiff_t next_of(ptrdiff_t h)
{
    return (h & ~(ptrdiff_t)3) | ((h + 1) & 3);
}

static ptrdiff_t previous_of(ptrdiff_t h)
{
    return (h & ~(ptrdiff_t)3) | ((h + 3) & 3);
}

static ptrdiff_t start_of(const HalfEdges *mesh, ptrdiff_t h)
{
    return mesh->quads[h];
}

static ptrdiff_t end_of(const HalfEdges *mesh, ptrdiff_t h)
{
    return mesh->quads[next_of(h)];
}

static ptrdiff_t high_of(const HalfEdges *mesh, ptrdiff_t h)
{
    const ptrdiff_t a = start_of(mesh, h), b = end_of(mesh, h);
    return a > b ? a : b;
}

/* Sort half-edges by their lower node, `first` (n + 1) being where those of each begin, then by the higher. */
static void sort_half_edges(const HalfEdges *mesh, ptrdiff_t *first, ptrdiff_t *order)
{
    const ptrdiff_t halves = 4 * mesh->m;
    for (ptrdiff_t v = 0; v <= mesh->n; v++)
        first[v] = 0;
    for (ptrdiff_t h = 0; h < halves; h++) {
        const ptrdiff_t a = start_of(mesh, h), b = end_of(mesh, h);
        first[(a < b ? a : b) + 1]++;
    }
    for (ptrdiff_t v = 0; v < mesh->n; v++)
        first[v + 1] += first[v];
    for (ptrdiff_t h = halves - 1; h >= 0; h--) { /* from behind, so that first ends up at the begin of the next */
        const ptrdiff_t a = start_of(mesh, h), b = end_of(mesh, h);
        order[--first[(a < b ? a : b) + 1]] = h;
    }
    for (ptrdiff_t v = 0; v < mesh->n; v++) {
        const ptrdiff_t begin = first[v + 1], end = v + 2 <= mesh->n ? first[v + 2] : halves;
        for (ptrdiff_t k = begin + 1; k < end; k++) { /* a handful */
            const ptrdiff_t h = order[k];
            ptrdiff_t j = k;
            for (; j > begin && high_of(mesh, order[j - 1]) > high_of(mesh, h); j--)
                order[j] = order[j - 1];
            order[j] = h;
        }
    }
}

void mesh_connect(HalfEdges *mesh, ptrdiff_t *room)
{
    ptrdiff_t *first = room, *order = room + mesh->n + 1, count = 0;
    const ptrdiff_t halves = 4 * mesh->m;
    sort_half_edges(mesh, first, order);
    mesh->manifold = 1;
    for (ptrdiff_t k = 0; k < halves;) {
        const ptrdiff_t h = order[k], a = start_of(mesh, h), b = end_of(mesh, h), low = a < b ? a : b, high = a + b - low;
        ptrdiff_t end = k;
        for (; end < halves; end++) {
            const ptrdiff_t g = order[end], c = start_of(mesh, g), d = end_of(mesh, g);
            if (!((c == low && d == high) || (c == high && d == low)))
                break;
            mesh->edge[g] = count, mesh->twin[g] = -1;
        }
        if (end - k == 2 && a != start_of(mesh, order[k + 1]))
            mesh->twin[h] = order[k + 1], mesh->twin[order[k + 1]] = h;
        else if (end - k != 1)
            mesh->manifold = 0;
        mesh->ends[2 * count] = low, mesh->ends[2 * count + 1] = high;
        count++, k = end;
    }
    mesh->edges = count;
}

static ptrdiff_t root_of(ptrdiff_t *parent, ptrdiff_t k)
{
    while (parent[k] != k)
        k = parent[k] = parent[parent[k]];
    return k;
}

static void join(ptrdiff_t *parent, ptrdiff_t a, ptrdiff_t b)
{
    a = root_of(parent, a), b = root_of(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* Label the roots in order; the root of a class is its lowest number. */
static ptrdiff_t label_roots(ptrdiff_t *parent, ptrdiff_t n, ptrdiff_t *label)
{
    ptrdiff_t count = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const ptrdiff_t root = root_of(parent, k);
        label[k] = root == k ? count++ : label[root];
    }
    return count;
}

ptrdiff_t joined_classes(const ptrdiff_t *pairs, ptrdiff_t k, ptrdiff_t n, ptrdiff_t *label, ptrdiff_t *parent)
{
    for (ptrdiff_t v = 0; v < n; v++)
        parent[v] = v;
    for (ptrdiff_t p = 0; p < k; p++)
        join(parent, pairs[2 * p], pairs[2 * p + 1]);
    return label_roots(parent, n, label);
}

/* Mark the line that starts with a half-edge, up to a wall, an irregular node or a line that is marked. */
static void mark_line(const HalfEdges *mesh, const unsigned char *irregular, unsigned char *marked, ptrdiff_t h)
{
    while (!marked[mesh->edge[h]]) {
        marked[mesh->edge[h]] = 1;
        if (irregular[end_of(mesh, h)])
            return;
        const ptrdiff_t across = mesh->twin[next_of(h)];
        if (across < 0)
            return; /* the next edge is a wall */
        h = next_of(across);
    }
}

/* Label the quads that unmarked edges join; count the corners (count) of each. */
static ptrdiff_t label_blocks(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t *label, ptrdiff_t *corners,
                              ptrdiff_t *stack)
{
    ptrdiff_t count = 0;
    for (ptrdiff_t q = 0; q < mesh->m; q++)
        label[q] = -1;
    for (ptrdiff_t seed = 0; seed < mesh->m; seed++) {
        if (label[seed] >= 0)
            continue;
        ptrdiff_t top = 0;
        corners[count] = 0, label[seed] = count, stack[top++] = seed;
        while (top) {
            const ptrdiff_t q = stack[--top];
            for (ptrdiff_t h = 4 * q; h < 4 * q + 4; h++) {
                const int wall = marked[mesh->edge[h]];
                corners[count] += wall && marked[mesh->edge[previous_of(h)]];
                if (wall || mesh->twin[h] < 0 || label[mesh->twin[h] / 4] >= 0)
                    continue;
                label[mesh->twin[h] / 4] = count, stack[top++] = mesh->twin[h] / 4;
            }
        }
        count++;
    }
    return count;
}

/* Mark one more line through the block that `label` calls `block`, a ring; return whether there was one to mark. */
static int cut_ring(const HalfEdges *mesh, const unsigned char *irregular, unsigned char *marked, const ptrdiff_t *label,
                    ptrdiff_t block)
{
    for (ptrdiff_t h = 0; h < 4 * mesh->m; h++) {
        if (label[h / 4] != block || marked[mesh->edge[h]] || mesh->twin[h] < 0)
            continue;
        if (!marked[mesh->edge[previous_of(h)]] && !marked[mesh->edge[next_of(h)]])
            continue;
        const ptrdiff_t edge = mesh->edge[h];
        mark_line(mesh, irregular, marked, h);
        marked[edge] = 0; /* for the way back */
        mark_line(mesh, irregular, marked, mesh->twin[h]);
        return 1;
    }
    return 0;
}

ptrdiff_t mesh_blocks(const HalfEdges *mesh, const unsigned char *irregular, unsigned char *marked, ptrdiff_t *label,
                      ptrdiff_t *room)
{
    ptrdiff_t *corners = room, *stack = room + mesh->m;
    for (ptrdiff_t h = 0; h < 4 * mesh->m; h++)
        if (mesh->twin[h] < 0)
            marked[mesh->edge[h]] = 1;
    for (ptrdiff_t h = 0; h < 4 * mesh->m; h++)
        if (irregular[start_of(mesh, h)])
            mark_line(mesh, irregular, marked, h);
    for (;;) {
        const ptrdiff_t count = label_blocks(mesh, marked, label, corners, stack);
        ptrdiff_t bad = 0;
        while (bad < count && corners[bad] == 4)
            bad++;
        if (bad == count)
            return count;
        if (!cut_ring(mesh, irregular, marked, label, bad))
            return -1;
    }
}

/* Write one row of corners along half-edge `h` and its continuations, up to a marked edge; return how many quads, or -1 for
   more than `most`. `low` gets the nodes along it, `high` those on the other side of its quads. */
static ptrdiff_t row_of(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t h, ptrdiff_t most, ptrdiff_t *low,
                        ptrdiff_t *high)
{
    const ptrdiff_t *quads = mesh->quads;
    ptrdiff_t length = 0;
    for (;;) {
        const ptrdiff_t ahead = next_of(h);
        if (length >= most)
            return -1;
        low[length] = quads[h], high[length] = quads[previous_of(h)];
        low[length + 1] = quads[ahead], high[length + 1] = quads[next_of(ahead)];
        length++;
        if (marked[mesh->edge[ahead]])
            return length;
        h = next_of(mesh->twin[ahead]);
    }
}

/* Write the lattice of a block of `cells` quads from the half-edge along its south side; return whether it is whole. */
static int lattice_of(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t h, ptrdiff_t cells, ptrdiff_t *size,
                      ptrdiff_t *lattice, ptrdiff_t *room)
{
    ptrdiff_t *rows = room; /* rows of nodes one after another, south first */
    ptrdiff_t wide = 0, high = 0;
    for (;;) {
        ptrdiff_t *row = rows + high * (wide + 1);
        const ptrdiff_t length = row_of(mesh, marked, h, cells - high * wide, row, row + (wide ? wide + 1 : cells + 1));
        if (length < 0 || (wide && length != wide))
            return 0;
        if (!wide) { /* the first row tells where the second has to be */
            wide = length;
            for (ptrdiff_t i = 0; i <= wide; i++)
                rows[wide + 1 + i] = rows[cells + 1 + i];
        }
        high++;
        const ptrdiff_t up = next_of(next_of(h)); /* runs back along the top of the first quad */
        if (marked[mesh->edge[up]])
            break;
        h = mesh->twin[up];
    }
    if (wide * high != cells)
        return 0;
    size[0] = wide + 1, size[1] = high + 1;
    for (ptrdiff_t i = 0; i <= wide; i++)
        for (ptrdiff_t j = 0; j <= high; j++)
            lattice[i * (high + 1) + j] = rows[j * (wide + 1) + i];
    return 1;
}

ptrdiff_t mesh_lattices(const HalfEdges *mesh, const unsigned char *marked, const ptrdiff_t *label, ptrdiff_t count,
                        ptrdiff_t *sizes, ptrdiff_t *lattices, ptrdiff_t *room)
{
    ptrdiff_t *corner = room, *cells = room + count, *rows = room + 2 * count, written = 0;
    for (ptrdiff_t b = 0; b < count; b++)
        corner[b] = -1, cells[b] = 0;
    for (ptrdiff_t h = 0; h < 4 * mesh->m; h++) {
        const ptrdiff_t b = label[h / 4];
        cells[b] += (h & 3) == 0;
        if (corner[b] < 0 && marked[mesh->edge[h]] && marked[mesh->edge[previous_of(h)]])
            corner[b] = h;
    }
    for (ptrdiff_t b = 0; b < count; b++) {
        if (corner[b] < 0 ||
            !lattice_of(mesh, marked, corner[b], cells[b], sizes + 2 * b, lattices + written, rows))
            return -1;
        written += sizes[2 * b] * sizes[2 * b + 1];
    }
    return written;
}

ptrdiff_t mesh_chords(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t *label, ptrdiff_t *room)
{
    ptrdiff_t *parent = room;
    for (ptrdiff_t k = 0; k < mesh->edges; k++)
        parent[k] = k;
    for (ptrdiff_t h = 0; h < 4 * mesh->m; h++) {
        if ((h & 3) < 2)
            join(parent, mesh->edge[h], mesh->edge[h + 2]);
        if (marked && mesh->twin[h] > h && !marked[mesh->edge[h]])
            join(parent, mesh->edge[next_of(h)], mesh->edge[next_of(mesh->twin[h])]);
    }
    return label_roots(parent, mesh->edges, label);
}
