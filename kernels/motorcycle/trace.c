#include "trace.h"
#include "steps.h"
#include <stdlib.h>

/* Where a ray is: in triangle `face`, entered across `edge`, or at its start at `corner` (edge -1). */
typedef struct {
    ptrdiff_t face, edge, corner, axis;
    MapPoint at;
    double length;
} State;

/* How a ray leaves its triangle, in coordinates turned so that it runs along x. */
typedef struct {
    MapPoint start, stop;  /* turned */
    ptrdiff_t edge;     /* left across this */
    double part;        /* of that edge, from its first corner */
    ptrdiff_t corner;   /* of the node that it meets, or -1 */
    ptrdiff_t node, port;
} Way;

/* The side of a corner is decided once, when it first lies ahead, and kept by entering across an edge: rays that pass
   closely never disagree with themselves. */
static Way way_out(const RayLines *lines, const State *s)
{
    const MapPoint *w = lines->map.coordinates + 3 * s->face;
    MapPoint r[3];
    double off[3];
    Way way = {.start = turned(s->at, -s->axis), .corner = -1};
    for (int i = 0; i < 3; i++) {
        r[i] = turned(w[i], -s->axis);
        off[i] = r[i].y - way.start.y;
    }
    ptrdiff_t left, right, ahead[2], count = 1;
    if (s->edge < 0) {
        right = ahead[0] = (s->corner + 1) % 3, left = ahead[1] = (s->corner + 2) % 3, count = 2;
    } else {
        const ptrdiff_t opposite = ahead[0] = (s->edge + 2) % 3;
        left = off[opposite] >= 0 ? opposite : s->edge;
        right = off[opposite] >= 0 ? (s->edge + 1) % 3 : opposite;
    }
    way.edge = right;
    const double gap = off[left] - off[right], size = fabs(r[1].x - r[0].x) + fabs(r[1].y - r[0].y) +
                                                      fabs(r[2].x - r[0].x) + fabs(r[2].y - r[0].y);
    const double part = gap != 0 ? -off[right] / gap : 0.5;
    way.part = part < 0 ? 0 : part > 1 ? 1 : part;
    way.stop = (MapPoint){r[right].x + way.part * (r[left].x - r[right].x), way.start.y};
    for (ptrdiff_t i = 0; i < count; i++) {
        const ptrdiff_t c = ahead[i], node = lines->node[3 * s->face + c];
        if (node < 0 || fabs(off[c]) >= lines->near * size || r[c].x <= way.start.x)
            continue;
        const ptrdiff_t port = lines->port[12 * s->face + 4 * c + ((s->axis + 2) & 3)];
        if (port >= 0)
            way.corner = c, way.node = node, way.port = port;
    }
    return way;
}

/* Go on into the triangle across the edge; false at the wall. */
static int go_on(const TriangleMap *map, State *s, const Way *way)
{
    const ptrdiff_t side = 3 * s->face + way->edge, next = map->neighbours[side];
    if (next < 0)
        return 0;
    const MapPoint exit = turned(way->stop, s->axis);
    s->at = across(map, s->face, way->edge, exit);
    s->axis = (s->axis + map->turns[side]) & 3;
    s->edge = map->edges[side];
    s->face = next;
    return 1;
}

static State at_start(const TriangleMap *map, const RayStart *start)
{
    return (State){.face = start->face,
                   .edge = -1,
                   .corner = start->corner,
                   .axis = start->axis,
                   .at = map->coordinates[3 * start->face + start->corner]};
}

void probe_rays(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit, ptrdiff_t *met)
{
    for (ptrdiff_t r = 0; r < rays; r++) {
        State s = at_start(&lines->map, starts + r);
        met[2 * r] = met[2 * r + 1] = -1;
        for (ptrdiff_t step = 0; step < limit; step++) {
            const Way way = way_out(lines, &s);
            if (way.corner >= 0) {
                met[2 * r] = way.node, met[2 * r + 1] = way.port;
                break;
            }
            if (!go_on(&lines->map, &s, &way))
                break;
        }
    }
}

/* All that tracing keeps: the pieces in each triangle as chains, the nodes at which pieces start and end, and which ports
   are taken by rays that came in. */
typedef struct {
    const RayLines *lines;
    const RayStart *starts;
    State *states;
    RayEnd *ends;
    RayPiece *pieces;
    ptrdiff_t count, room;
    ptrdiff_t *steps, *ray_at, *first, *next, *nodes_of, *heap, heap_size;
    unsigned char *arrived;
} Tracing;

static int before(const Tracing *t, ptrdiff_t a, ptrdiff_t b)
{
    const double la = t->states[a].length, lb = t->states[b].length;
    return la < lb || (la == lb && a < b);
}

static void push(Tracing *t, ptrdiff_t ray)
{
    ptrdiff_t i = t->heap_size++;
    for (; i > 0 && before(t, ray, t->heap[(i - 1) / 2]); i = (i - 1) / 2)
        t->heap[i] = t->heap[(i - 1) / 2];
    t->heap[i] = ray;
}

static ptrdiff_t pop(Tracing *t)
{
    const ptrdiff_t top = t->heap[0], last = t->heap[--t->heap_size];
    ptrdiff_t i = 0;
    for (ptrdiff_t child; (child = 2 * i + 1) < t->heap_size; i = child) {
        if (child + 1 < t->heap_size && before(t, t->heap[child + 1], t->heap[child]))
            child++;
        if (!before(t, t->heap[child], last))
            break;
        t->heap[i] = t->heap[child];
    }
    t->heap[i] = last;
    return top;
}

/* The first piece across the way, -1 if there is none. Pieces that start or end at the node where the ray starts or ends
   do not stop it: a ray may come home to the node that it, or this one, left. */
static ptrdiff_t first_hit(const Tracing *t, const State *s, const Way *way, ptrdiff_t from, double *x)
{
    ptrdiff_t hit = -1;
    const ptrdiff_t to = way->corner >= 0 ? way->node : -1;
    for (ptrdiff_t i = t->first[s->face]; i >= 0; i = t->next[i]) {
        const RayPiece *piece = t->pieces + i;
        if (((piece->axis - s->axis) & 1) == 0)
            continue;
        const ptrdiff_t a = t->nodes_of[2 * i], b = t->nodes_of[2 * i + 1];
        if ((from >= 0 && (a == from || b == from)) || (to >= 0 && (a == to || b == to)))
            continue;
        const MapPoint p = turned(piece->from, -s->axis), q = turned(piece->to, -s->axis);
        const double low = p.y < q.y ? p.y : q.y, high = p.y < q.y ? q.y : p.y;
        if (p.x <= way->start.x || p.x > way->stop.x || way->start.y < low || way->start.y > high)
            continue;
        if (hit < 0 || p.x < *x)
            hit = i, *x = p.x;
    }
    return hit;
}

static void draw(Tracing *t, ptrdiff_t ray, const State *s, MapPoint from, MapPoint to, ptrdiff_t start, ptrdiff_t stop)
{
    const ptrdiff_t i = t->count++;
    t->pieces[i] = (RayPiece){ray, s->face, s->axis, turned(from, s->axis), to, s->length};
    t->nodes_of[2 * i] = start, t->nodes_of[2 * i + 1] = stop;
    t->next[i] = t->first[s->face], t->first[s->face] = i;
}

static void meet_ray(Tracing *t, ptrdiff_t ray, State *s, const Way *way, ptrdiff_t from, ptrdiff_t hit, double x)
{
    const RayPiece other = t->pieces[hit];
    const double into = fabs(way->start.y - turned(other.from, -s->axis).y);
    const ptrdiff_t side = ((s->axis + 2 - other.axis) & 3) == 1 ? 1 : 3;
    draw(t, ray, s, way->start, turned((MapPoint){x, way->start.y}, s->axis), from, -1);
    s->length += x - way->start.x;
    t->ends[ray] = (RayEnd){RAY_AT_RAY, other.ray, side, other.length + into, s->length};
}

static void meet_node(Tracing *t, ptrdiff_t ray, State *s, const Way *way, ptrdiff_t from)
{
    const MapPoint corner = t->lines->map.coordinates[3 * s->face + way->corner];
    draw(t, ray, s, way->start, corner, from, way->node);
    s->length += turned(corner, -s->axis).x - way->start.x;
    t->arrived[way->node * t->lines->ports + way->port] = 1;
    t->ends[ray] = (RayEnd){RAY_AT_NODE, way->node, way->port, 0, s->length};
}

/* Let a ray run to the end of its triangle; true if it goes on. */
static int run(Tracing *t, ptrdiff_t ray)
{
    State *s = t->states + ray;
    const RayLines *lines = t->lines;
    const ptrdiff_t from = t->steps[ray] == 0 ? t->starts[ray].node : -1;
    Way way = way_out(lines, s);
    if (way.corner >= 0) { /* not where another came in, or left */
        const ptrdiff_t key = way.node * lines->ports + way.port, owner = t->ray_at[key];
        if (t->arrived[key] || (owner >= 0 && t->steps[owner] > 0))
            way.corner = -1;
        else
            way.stop.x = turned(lines->map.coordinates[3 * s->face + way.corner], -s->axis).x;
    }
    double x = 0;
    const ptrdiff_t hit = first_hit(t, s, &way, from, &x);
    t->steps[ray]++;
    if (hit >= 0) {
        meet_ray(t, ray, s, &way, from, hit, x);
        return 0;
    }
    if (way.corner >= 0) {
        meet_node(t, ray, s, &way, from);
        return 0;
    }
    draw(t, ray, s, way.start, turned(way.stop, s->axis), from, -1);
    s->length += way.stop.x - way.start.x;
    const ptrdiff_t face = s->face;
    if (go_on(&lines->map, s, &way))
        return 1;
    t->ends[ray] = (RayEnd){RAY_AT_WALL, face, way.edge, way.part, s->length};
    return 0;
}

static ptrdiff_t run_all(Tracing *t, ptrdiff_t rays, ptrdiff_t limit)
{
    ptrdiff_t left = rays;
    for (ptrdiff_t batch = 0; left > 0 && batch < rays + 2; batch++) {
        for (ptrdiff_t r = 0; r < rays; r++)
            if (t->starts[r].batch == batch)
                push(t, r), left--;
        while (t->heap_size > 0) {
            const ptrdiff_t ray = pop(t), key = t->starts[ray].node * t->lines->ports + t->starts[ray].port;
            if (t->steps[ray] == 0 && t->arrived[key])
                continue; /* it would run back along the ray that came in */
            if (t->count >= t->room)
                return -1;
            if (t->steps[ray] >= limit)
                t->ends[ray].kind = RAY_TOO_LONG;
            else if (run(t, ray))
                push(t, ray);
        }
    }
    return t->count;
}

ptrdiff_t trace_rays(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit, RayEnd *ends, RayPiece *pieces,
                     ptrdiff_t room)
{
    const ptrdiff_t faces = lines->map.triangles, keys = lines->nodes * lines->ports;
    Tracing t = {.lines = lines, .starts = starts, .ends = ends, .pieces = pieces, .room = room};
    ptrdiff_t *whole = malloc((2 * rays + keys + faces + 3 * room + 1) * sizeof *whole), done = -2;
    t.states = malloc((rays + 1) * sizeof *t.states);
    t.arrived = calloc(keys + 1, 1);
    if (whole && t.states && t.arrived) {
        t.steps = whole, t.heap = t.steps + rays, t.ray_at = t.heap + rays, t.first = t.ray_at + keys;
        t.next = t.first + faces, t.nodes_of = t.next + room;
        for (ptrdiff_t i = 0; i < keys; i++)
            t.ray_at[i] = -1;
        for (ptrdiff_t i = 0; i < faces; i++)
            t.first[i] = -1;
        for (ptrdiff_t r = 0; r < rays; r++) {
            t.steps[r] = 0;
            t.states[r] = at_start(&lines->map, starts + r);
            t.ray_at[starts[r].node * lines->ports + starts[r].port] = r;
            ends[r] = (RayEnd){.kind = RAY_CANCELLED};
        }
        done = run_all(&t, rays, limit);
    }
    free(whole);
    free(t.states);
    free(t.arrived);
    return done;
}
