/* Half-spaces that an inner node next to faces must be in, and whether they have a point in common.

   At a node q of a face, corners of four cells have one edge to the inner node p and two in the face, with the normal n.
   They are valid if n·(p - q) > 0. By Helly's theorem such half-spaces have no common point exactly if four of them
   have none. By Farkas' lemma four have none if λ >= 0, Σ λ n = 0 and Σ λ n·q >= 0; λ of four normals are the
   determinants of three of them. */
#include "near_faces.h"
#include "corner3.h"
#include "team.h"

#define ROUNDING 1e-12 /* relative */
#define PLAINLY 0.05 /* products of normals with their sum above which half-spaces have a common point */
#define FLAT 1e-4    /* sum of four determinants below which normals are nearly in a plane */
#define CHUNK 256    /* nodes that a thread takes at a time */

typedef struct {
    Vector normal;
    double bound; /* of normal · p */
} Half;

typedef struct {
    const Wall3 *walls;
    int count;
    const ptrdiff_t *first, *last;
    Vector centre;
    ptrdiff_t found[TEAM_MOST];
} Search;

static Vector from_to(const double *from, const double *to)
{
    return (Vector){to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}

/* The four half-spaces of the node of a wall at (p, q). */
MESHONET_INLINE void half_spaces(const Wall3 *wall, ptrdiff_t p, ptrdiff_t q, Vector centre, Half *halves)
{
    const double *here = wall->nodes + 3 * (p * wall->m + q);
    const double inwards = (wall->end ? -1.0 : 1.0) * (wall->axis == 1 ? -1.0 : 1.0);
    const Vector place = {here[0] - centre.x, here[1] - centre.y, here[2] - centre.z};
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            const Vector along = from_to(here, here + (a ? 3 : -3) * wall->m), across = from_to(here, here + (b ? 3 : -3));
            const Vector n = cross(along, across);
            const double sign = a == b ? inwards : -inwards, length = sqrt(dot(n, n));
            const double by = sign / (length > 1e-300 ? length : 1e-300);
            Half *half = halves + 2 * a + b;
            half->normal = (Vector){by * n.x, by * n.y, by * n.z};
            half->bound = dot(half->normal, place);
        }
}

static int plainly_open(const Half *h)
{
    Vector sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < 4; k++)
        sum.x += h[k].normal.x, sum.y += h[k].normal.y, sum.z += h[k].normal.z;
    for (int k = 0; k < 4; k++)
        if (!(dot(sum, h[k].normal) > PLAINLY))
            return 0;
    return 1;
}

static double determinant(const Half *a, const Half *b, const Half *c)
{
    return dot(a->normal, cross(b->normal, c->normal));
}

static int four_are_apart(const Half *a, const Half *b, const Half *c, const Half *d)
{
    double share[4] = {determinant(b, c, d), -determinant(a, c, d), determinant(a, b, d), -determinant(a, b, c)};
    const double bound[4] = {a->bound, b->bound, c->bound, d->bound};
    double total = share[0] + share[1] + share[2] + share[3], sum = 0.0, size = 0.0;
    const double sign = total < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 4; k++) {
        if (sign * share[k] < 0.0)
            return 0;
        sum += sign * share[k] * bound[k], size += sign * share[k] * fabs(bound[k]);
    }
    return sign * total > FLAT && sum >= -ROUNDING * size;
}

/* Opposite half-spaces, as of plane faces. */
static int two_are_apart(const Half *a, const Half *b)
{
    return dot(a->normal, b->normal) < -1.0 + ROUNDING && a->bound + b->bound >= -ROUNDING * fabs(a->bound);
}

static int closed(const Half *halves, int count)
{
    for (int a = 0; a < count; a++)
        for (int b = a + 1; b < count; b++) {
            if (two_are_apart(halves + a, halves + b))
                return 1;
            for (int c = b + 1; c < count; c++)
                for (int d = c + 1; d < count; d++)
                    if (four_are_apart(halves + a, halves + b, halves + c, halves + d))
                        return 1;
        }
    return 0;
}

static int closed_at(const Search *s, ptrdiff_t number)
{
    const ptrdiff_t m2 = s->last[1] - s->first[1], m3 = s->last[2] - s->first[2];
    const ptrdiff_t at[3] = {s->first[0] + number / (m2 * m3), s->first[1] + number / m3 % m2, s->first[2] + number % m3};
    Half halves[12];
    for (int w = 0; w < s->count; w++) {
        const Wall3 *wall = s->walls + w;
        half_spaces(wall, at[wall->axis == 0], at[wall->axis == 2 ? 1 : 2], s->centre, halves + 4 * w);
    }
    return !(s->count == 1 && plainly_open(halves)) && closed(halves, 4 * s->count);
}

static void search(void *data, Member member)
{
    Search *s = data;
    ptrdiff_t count = 1;
    for (int e = 0; e < 3; e++)
        count *= s->last[e] - s->first[e];
    const Range mine = team_share((count + CHUNK - 1) / CHUNK, member);
    s->found[member.rank] = -1;
    for (ptrdiff_t k = mine.first * CHUNK; k < mine.last * CHUNK && k < count && s->found[member.rank] < 0; k++)
        if (closed_at(s, k))
            s->found[member.rank] = k;
}

ptrdiff_t closed_node(const Wall3 *walls, int count, const ptrdiff_t *first, const ptrdiff_t *last, int threads)
{
    const double *corner = walls[0].nodes;
    Search s = {walls, count, first, last, {corner[0], corner[1], corner[2]}, {0}};
    for (int k = 0; k < TEAM_MOST; k++)
        s.found[k] = -1;
    team_run(threads, search, &s);
    for (int k = 0; k < TEAM_MOST; k++)
        if (s.found[k] >= 0)
            return s.found[k];
    return -1;
}
