/* Circumcentres inserted worst triangle first (Ruppert 1995, Shewchuk 1997), to given sizes; walls are not split. */
#include "refine.h"
#include <math.h>
#include <stdlib.h>

#define RADIUS 0.75 /* of the size, largest of a circle that stays empty */

#define ENOUGH 0.5   /* sine of an angle that is not a small one */

static const int NEXT[3] = {1, 2, 0}, AFTER[3] = {2, 0, 1};

typedef struct {
    float worth; /* single: triangles that are alike but for rounding are equally bad, and come in order */
    int32_t triangle;
    uint32_t stamp;
} Entry;

typedef struct {
    Entry *entry; /* a heap, the largest first */
    ptrdiff_t n, room;
} Heap;

static int heap_push(Heap *heap, Entry entry)
{
    if (heap->n == heap->room) {
        const ptrdiff_t wanted = heap->room ? 2 * heap->room : 4096;
        Entry *more = realloc(heap->entry, (size_t)wanted * sizeof(Entry));
        if (!more)
            return OUT_OF_MEMORY;
        heap->entry = more, heap->room = wanted;
    }
    ptrdiff_t k = heap->n++;
    for (; k > 0 && heap->entry[(k - 1) / 2].worth < entry.worth; k = (k - 1) / 2)
        heap->entry[k] = heap->entry[(k - 1) / 2];
    heap->entry[k] = entry;
    return 0;
}

static Entry heap_pop(Heap *heap)
{
    const Entry top = heap->entry[0], last = heap->entry[--heap->n];
    ptrdiff_t k = 0;
    for (;;) {
        ptrdiff_t child = 2 * k + 1;
        if (child >= heap->n)
            break;
        if (child + 1 < heap->n && heap->entry[child + 1].worth > heap->entry[child].worth)
            child++;
        if (heap->entry[child].worth <= last.worth)
            break;
        heap->entry[k] = heap->entry[child], k = child;
    }
    heap->entry[k] = last;
    return top;
}

static double distance(Node a, Node b)
{
    const double x = (double)(b.x - a.x), y = (double)(b.y - a.y);
    return sqrt(x * x + y * y);
}

/* Size allowed at p by the sources. */
static double size_of_sources(const Sizes *sizes, Node p)
{
    double size = sizes->largest;
    for (ptrdiff_t k = 0; k < sizes->n_sources; k++) {
        const double x = sizes->source[2 * k] - (double)p.x, y = sizes->source[2 * k + 1] - (double)p.y;
        const double here = sizes->source_size[k] + sizes->growth * sqrt(x * x + y * y);
        size = here < size ? here : size;
    }
    return size;
}

/* Centre and radius of the circle through the corners; 0 where it lies out of the box. */
static int circle(const Mesh *mesh, const Triangle *t, Node *centre, double *radius)
{
    const Node a = mesh->node[t->corner[0]], b = mesh->node[t->corner[1]], c = mesh->node[t->corner[2]];
    const double bx = (double)(b.x - a.x), by = (double)(b.y - a.y), cx = (double)(c.x - a.x), cy = (double)(c.y - a.y);
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy, d = 2.0 * (double)turn(a, b, c);
    if (!(d > 0))
        return 0;
    const double x = (cy * b2 - by * c2) / d, y = (bx * c2 - cx * b2) / d, top = (double)((int64_t)1 << SIDE_BITS);
    *radius = sqrt(x * x + y * y);
    if (!(*radius < top))
        return 0;
    *centre = (Node){a.x + llrint(x), a.y + llrint(y)};
    return centre->x > 0 && centre->y > 0 && centre->x < top && centre->y < top;
}

/* Put a triangle on the heap where its circle is too large. */
static int consider(const Mesh *mesh, Heap *heap, const Sizes *sizes, int32_t t)
{
    const Triangle *here = &mesh->triangle[t];
    Node centre;
    double radius;
    if (!here->inside || !circle(mesh, here, &centre, &radius))
        return 0;
    double size = mesh->size[here->corner[0]];
    for (int k = 1; k < 3; k++)
        size = mesh->size[here->corner[k]] < size ? mesh->size[here->corner[k]] : size;
    size += sizes->growth * radius;
    if (radius > RADIUS * size || radius > RADIUS * sizes->largest || sizes->n_sources) {
        const double limit = size_of_sources(sizes, centre);
        size = limit < size ? limit : size;
    }
    return radius > RADIUS * size ? heap_push(heap, (Entry){(float)(radius / size), t, here->stamp}) : 0;
}

/* Whether p, inside of triangle t, lies in the circle over a wall that it would see; or OUT_OF_MEMORY. */
static int too_near_wall(Mesh *mesh, Node p, int32_t t)
{
    int near = 0;
    mesh->triangle[t].seen = ++mesh->searches;
    if (mesh_push(mesh, t, 0))
        return OUT_OF_MEMORY;
    while (mesh->depth) {
        const Triangle *here = &mesh->triangle[mesh->stack[2 * --mesh->depth]];
        for (int i = 0; i < 3 && !near; i++) {
            const Node a = mesh->node[here->corner[NEXT[i]]], b = mesh->node[here->corner[AFTER[i]]];
            if (here->wall[i]) {
                near = (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y) <= 0;
                continue;
            }
            const int32_t u = here->beside[i];
            if (u < 0 || mesh->triangle[u].seen == mesh->searches)
                continue;
            Triangle *there = &mesh->triangle[u];
            there->seen = mesh->searches;
            if (in_circle(mesh->node[there->corner[0]], mesh->node[there->corner[1]], mesh->node[there->corner[2]],
                          p) && mesh_push(mesh, u, 0))
                return OUT_OF_MEMORY;
        }
    }
    return near;
}

/* The size at node v from those around it. */
static void take_size(Mesh *mesh, const Sizes *sizes, int32_t v)
{
    double size = size_of_sources(sizes, mesh->node[v]);
    const int32_t start = mesh->at[v];
    int32_t t = start;
    do {
        const Triangle *here = &mesh->triangle[t];
        const int k = here->corner[0] == v ? 0 : here->corner[1] == v ? 1 : 2;
        const int32_t other = here->corner[NEXT[k]];
        const double allowed = mesh->size[other] + sizes->growth * distance(mesh->node[v], mesh->node[other]);
        size = allowed < size ? allowed : size;
        t = here->beside[NEXT[k]];
    } while (t != start);
    mesh->size[v] = size;
}

static int refine_with(Mesh *mesh, const Sizes *sizes, ptrdiff_t most, Heap *heap)
{
    for (int32_t t = 0; t < mesh->m; t++)
        if (consider(mesh, heap, sizes, t))
            return OUT_OF_MEMORY;
    while (heap->n && mesh->n < most) {
        const Entry worst = heap_pop(heap);
        const Triangle *old = &mesh->triangle[worst.triangle];
        Node centre;
        double radius;
        if (old->stamp != worst.stamp || !circle(mesh, old, &centre, &radius))
            continue;
        const int32_t t = mesh_find(mesh, centre, worst.triangle);
        if (t < 0 || !mesh->triangle[t].inside)
            continue;
        const int near = too_near_wall(mesh, centre, t);
        if (near < 0 || mesh_reserve(mesh, mesh->n + 1))
            return OUT_OF_MEMORY;
        if (near)
            continue;
        const int32_t v = (int32_t)mesh->n;
        mesh->node[v] = centre;
        const int status = mesh_insert(mesh, v, t);
        if (status == SAME_PLACE)
            continue;
        if (status)
            return status;
        mesh->n++;
        take_size(mesh, sizes, v);
        for (ptrdiff_t k = 0; k < mesh->n_changed; k++)
            if (consider(mesh, heap, sizes, mesh->changed[k]))
                return OUT_OF_MEMORY;
    }
    return 0;
}

int refine(Mesh *mesh, const Sizes *sizes, ptrdiff_t most)
{
    Heap heap = {0, 0, 0};
    const int status = refine_with(mesh, sizes, most, &heap);
    free(heap.entry);
    return status;
}

/* Sine of the smallest angle around node v, were it at `place`; 0 where a triangle would turn over. */
static double smallest_sine(const Mesh *mesh, int32_t v, Node place)
{
    const int32_t start = mesh->at[v];
    int32_t t = start;
    double least = 1.0;
    do {
        const Triangle *here = &mesh->triangle[t];
        const int k = here->corner[0] == v ? 0 : here->corner[1] == v ? 1 : 2;
        const Node a = mesh->node[here->corner[NEXT[k]]], b = mesh->node[here->corner[AFTER[k]]];
        const int64_t area = turn(place, a, b);
        if (area <= 0)
            return 0.0;
        const double pa = distance(place, a), pb = distance(place, b), ab = distance(a, b);
        const double shortest = pa < pb ? (pa < ab ? pa : ab) : (pb < ab ? pb : ab);
        const double sine = (double)area * shortest / (pa * pb * ab);
        least = sine < least ? sine : least;
        t = here->beside[NEXT[k]];
    } while (t != start);
    return least;
}

/* Move node v by dx, dy, or half or a quarter as far, where no angle falls below ENOUGH or what is there now. */
static void move(Mesh *mesh, int32_t v, double dx, double dy)
{
    const Node old = mesh->node[v];
    const double now = smallest_sine(mesh, v, old), least = now < ENOUGH ? now : ENOUGH;
    for (int k = 0; k < 3; k++, dx *= 0.5, dy *= 0.5) {
        const Node to = {old.x + llrint(dx), old.y + llrint(dy)};
        const double then = smallest_sine(mesh, v, to);
        if (then > 0 && then >= least) {
            mesh->node[v] = to;
            return;
        }
    }
}

int smooth(Mesh *mesh, ptrdiff_t first, double part)
{
    for (int32_t v = (int32_t)first; v < mesh->n; v++) {
        const int32_t start = mesh->at[v];
        int32_t t = start;
        int64_t x = 0, y = 0, count = 0;
        do {
            const Triangle *here = &mesh->triangle[t];
            const int k = here->corner[0] == v ? 0 : here->corner[1] == v ? 1 : 2;
            const Node other = mesh->node[here->corner[NEXT[k]]];
            x += other.x, y += other.y, count++;
            t = here->beside[NEXT[k]];
        } while (t != start);
        const Node old = mesh->node[v];
        const double dx = (double)(x - count * old.x) / (double)count, dy = (double)(y - count * old.y) / (double)count;
        move(mesh, v, part * dx, part * dy);
    }
    return mesh_flip_all(mesh);
}

/* A number from -1 to 1 (splitmix64, Steele, Lea, Flood 2014). */
static double random_number(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

int shake(Mesh *mesh, ptrdiff_t first, double part, uint64_t seed)
{
    for (int32_t v = (int32_t)first; v < mesh->n; v++) {
        const double x = random_number(&seed), y = random_number(&seed), reach = part * mesh->size[v];
        move(mesh, v, x * reach, y * reach);
    }
    return mesh_flip_all(mesh);
}
