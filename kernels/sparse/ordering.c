/* The quotient graph of the elimination: an eliminated vertex becomes an element, the clique of its neighbours. A
   variable's list has its elements first, then variables joined by entries. Equal variables are one of larger weight. */
#include "ordering.h"

#include <stdlib.h>
#include <string.h>

enum { NONE = -1 };

typedef struct {
    int n, left; /* weight of the variables that are left */
    int *list;
    ptrdiff_t used, room, *start;
    int *count, *elements; /* length of a list, how many of it are elements */
    int *weight;           /* of a variable; 0 when merged or eliminated */
    int *degree;           /* bound of a variable's weight of neighbours; weight of an element's list */
    int *alive;            /* is an element that no other has absorbed */
    int *front, *seen, *outside, *tag;
    int *head, *next, *previous; /* variables of each degree */
    int *bucket, *beside;        /* variables of each hash */
    int *chain, *last;           /* variables that are eliminated after this one */
    int stamp;
} Quotient;

static void link_degree(Quotient *q, int i)
{
    const int d = q->degree[i], first = q->head[d];
    q->next[i] = first;
    q->previous[i] = NONE;
    if (first != NONE)
        q->previous[first] = i;
    q->head[d] = i;
}

static void unlink_degree(Quotient *q, int i)
{
    const int before = q->previous[i], after = q->next[i];
    if (before == NONE)
        q->head[q->degree[i]] = after;
    else
        q->next[before] = after;
    if (after != NONE)
        q->previous[after] = before;
}

/* Take j into i: it is eliminated right after it. */
static void follow(Quotient *q, int i, int j)
{
    q->chain[q->last[i]] = j;
    q->last[i] = q->last[j];
    q->weight[j] = 0;
}

static int reserve(Quotient *q, ptrdiff_t more)
{
    if (q->used + more <= q->room)
        return 0;
    const ptrdiff_t room = 2 * q->room + more;
    int *grown = realloc(q->list, (size_t)room * sizeof *grown);
    if (!grown)
        return -1;
    q->list = grown;
    q->room = room;
    return 0;
}

static void join_front(Quotient *q, int p, ptrdiff_t from, int count)
{
    for (int k = 0; k < count; k++) {
        const int i = q->list[from + k];
        if (q->weight[i] == 0 || q->front[i] == p)
            continue;
        q->front[i] = p;
        q->degree[p] += q->weight[i];
        q->list[q->used++] = i;
        unlink_degree(q, i);
    }
}

/* Make an element of variable p: the list of all its neighbours, which absorbs its elements. */
static int eliminate(Quotient *q, int p)
{
    const ptrdiff_t own = q->start[p];
    const int elements = q->elements[p], count = q->count[p];
    ptrdiff_t most = count - elements;
    for (int k = 0; k < elements; k++)
        most += q->count[q->list[own + k]];
    if (reserve(q, most))
        return -1;
    const ptrdiff_t start = q->used;
    q->front[p] = p;
    q->degree[p] = 0;
    for (int k = 0; k < elements; k++) {
        const int e = q->list[own + k];
        if (!q->alive[e])
            continue;
        join_front(q, p, q->start[e], q->count[e]);
        q->alive[e] = 0;
    }
    join_front(q, p, own + elements, count - elements);
    q->start[p] = start;
    q->count[p] = (int)(q->used - start);
    q->alive[p] = 1;
    return 0;
}

/* The weight of every element near p that is not in p. */
static void measure_outside(Quotient *q, int p)
{
    for (ptrdiff_t k = q->start[p]; k < q->used; k++) {
        const int i = q->list[k];
        const int *list = q->list + q->start[i];
        for (int m = 0; m < q->elements[i]; m++) {
            const int e = list[m];
            if (!q->alive[e])
                continue;
            if (q->seen[e] != p) {
                q->seen[e] = p;
                q->outside[e] = q->degree[e];
            }
            q->outside[e] -= q->weight[i];
        }
    }
}

/* Write the list of variable i anew, p as its last element; return a hash of it, or NONE where p is all. */
static int renew(Quotient *q, int p, int i)
{
    int *list = q->list + q->start[i];
    const int elements = q->elements[i], count = q->count[i];
    int kept = 0, degree = 0;
    unsigned hash = (unsigned)p;
    for (int m = 0; m < elements; m++) {
        const int e = list[m];
        if (!q->alive[e])
            continue;
        if (q->outside[e] == 0) { /* within p */
            q->alive[e] = 0;
            continue;
        }
        degree += q->outside[e];
        hash += (unsigned)e;
        list[kept++] = e;
    }
    const int at = kept;
    for (int m = elements; m < count; m++) {
        const int j = list[m];
        if (q->weight[j] == 0 || q->front[j] == p)
            continue;
        degree += q->weight[j];
        hash += (unsigned)j;
        list[kept++] = j;
    }
    list[kept] = list[at]; /* what was taken out left room */
    list[at] = p;
    q->elements[i] = at + 1;
    q->count[i] = kept + 1;
    if (degree < q->degree[i])
        q->degree[i] = degree;
    return kept == 0 ? NONE : (int)(hash % (unsigned)q->n);
}

static int same_lists(const Quotient *q, int i, int j)
{
    if (q->count[i] != q->count[j] || q->elements[i] != q->elements[j])
        return 0;
    const int *list = q->list + q->start[j];
    for (int m = 0; m < q->count[j]; m++)
        if (q->tag[list[m]] != q->stamp)
            return 0;
    return 1;
}

/* Make one of all variables of a bucket that have the same list. */
static void merge_bucket(Quotient *q, int first)
{
    for (int i = first; i != NONE; i = q->beside[i]) {
        if (q->weight[i] == 0 || q->beside[i] == NONE)
            continue;
        const int *list = q->list + q->start[i];
        q->stamp++;
        for (int m = 0; m < q->count[i]; m++)
            q->tag[list[m]] = q->stamp;
        for (int j = q->beside[i]; j != NONE; j = q->beside[j])
            if (q->weight[j] && same_lists(q, i, j)) {
                q->weight[i] += q->weight[j];
                follow(q, i, j);
            }
    }
}

/* Bring the neighbours of the new element p up to date. */
static void update(Quotient *q, int p)
{
    const ptrdiff_t start = q->start[p], stop = q->used;
    measure_outside(q, p);
    for (ptrdiff_t k = start; k < stop; k++) {
        const int i = q->list[k], hash = renew(q, p, i);
        if (hash == NONE) { /* its neighbours are those of p */
            q->degree[p] -= q->weight[i];
            q->left -= q->weight[i];
            follow(q, p, i);
        } else {
            q->beside[i] = q->bucket[hash];
            q->bucket[hash] = i;
            q->outside[i] = hash;
        }
    }
    for (ptrdiff_t k = start; k < stop; k++) {
        const int i = q->list[k];
        if (q->weight[i] == 0)
            continue;
        const int hash = q->outside[i], first = q->bucket[hash];
        q->bucket[hash] = NONE;
        merge_bucket(q, first);
    }
    ptrdiff_t kept = start;
    for (ptrdiff_t k = start; k < stop; k++) {
        const int i = q->list[k];
        if (q->weight[i] == 0)
            continue;
        const int degree = q->degree[i] + q->degree[p] - q->weight[i], most = q->left - q->weight[i];
        q->degree[i] = degree < most ? degree : most;
        link_degree(q, i);
        q->list[kept++] = i;
    }
    q->count[p] = (int)(kept - start);
    q->used = kept;
}

static int run(Quotient *q, int *order)
{
    int done = 0, least = 0;
    while (done < q->n) {
        while (q->head[least] == NONE)
            least++;
        const int p = q->head[least];
        unlink_degree(q, p);
        q->left -= q->weight[p];
        if (eliminate(q, p))
            return -1;
        q->weight[p] = 0;
        update(q, p);
        for (int i = p; i != NONE; i = q->chain[i])
            order[done++] = i;
        for (int k = 0; k < q->count[p]; k++) {
            const int d = q->degree[q->list[q->start[p] + k]];
            if (d < least)
                least = d;
        }
    }
    return 0;
}

static void begin(Quotient *q, const ptrdiff_t *start, const int *list)
{
    const int n = q->n;
    memcpy(q->list, list, (size_t)start[n] * sizeof *list);
    q->used = start[n];
    for (int i = 0; i < n; i++) {
        q->start[i] = start[i];
        q->degree[i] = q->count[i] = (int)(start[i + 1] - start[i]);
        q->elements[i] = q->alive[i] = q->tag[i] = 0;
        q->weight[i] = 1;
        q->front[i] = q->seen[i] = q->head[i] = q->bucket[i] = q->chain[i] = NONE;
        q->last[i] = i;
    }
    for (int i = n - 1; i >= 0; i--)
        link_degree(q, i);
}

int minimum_degree(int n, const ptrdiff_t *start, const int *list, int *order)
{
    enum { ARRAYS = 16 };
    if (n == 0)
        return 0;
    Quotient q = {.n = n, .left = n, .room = 4 * start[n] + n};
    int *room = malloc((size_t)n * ARRAYS * sizeof *room), failed = -1;
    q.list = malloc((size_t)q.room * sizeof *q.list);
    q.start = malloc((size_t)n * sizeof *q.start);
    if (room && q.list && q.start) {
        int **arrays[ARRAYS] = {&q.count, &q.elements, &q.weight,   &q.degree, &q.alive,  &q.front, &q.seen,  &q.outside,
                                &q.tag,   &q.head,     &q.next,     &q.previous, &q.bucket, &q.beside, &q.chain, &q.last};
        for (int k = 0; k < ARRAYS; k++)
            *arrays[k] = room + (ptrdiff_t)k * n;
        begin(&q, start, list);
        failed = run(&q, order);
    }
    free(room);
    free(q.list);
    free(q.start);
    return failed;
}
