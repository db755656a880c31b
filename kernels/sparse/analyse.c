/* What a factor looks like, before any number is known: order, elimination tree, counts of its columns. */
#include "factor.h"
#include "ordering.h"

#include <stdlib.h>

enum { NONE = -1 };

typedef struct {
    ptrdiff_t *start;
    int *list;
} Graph;

/* The neighbours of every unknown, each once; `mark` (n) is scratch. */
static int make_graph(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns, int *mark, Graph *graph)
{
    ptrdiff_t *end = calloc((size_t)n + 1, sizeof *end);
    int *list = malloc(((size_t)m * 2 + 1) * sizeof *list);
    graph->start = end;
    graph->list = list;
    if (!end || !list)
        return -1;
    for (ptrdiff_t e = 0; e < m; e++)
        if (rows[e] != columns[e])
            end[rows[e] + 1]++, end[columns[e] + 1]++;
    for (int i = 0; i < n; i++)
        end[i + 1] += end[i];
    for (ptrdiff_t e = m; e-- > 0;) /* the start of i becomes its end, counted down again below */
        if (rows[e] != columns[e]) {
            list[end[rows[e]]++] = (int)columns[e];
            list[end[columns[e]]++] = (int)rows[e];
        }
    ptrdiff_t kept = 0, from = 0;
    for (int i = 0; i < n; i++)
        mark[i] = NONE;
    for (int i = 0; i < n; i++) {
        const ptrdiff_t to = end[i];
        end[i] = kept;
        for (; from < to; from++)
            if (mark[list[from]] != i) {
                mark[list[from]] = i;
                list[kept++] = list[from];
            }
    }
    end[n] = kept;
    return 0;
}

/* parent[k] of the k-th unknown in an order whose inverse is `place`; `root` (n) shortens the paths (Liu 1986). */
static void eliminate_tree(int n, const Graph *graph, const int *order, const int *place, int *parent, int *root)
{
    for (int k = 0; k < n; k++) {
        parent[k] = root[k] = NONE;
        for (ptrdiff_t e = graph->start[order[k]]; e < graph->start[order[k] + 1]; e++)
            for (int i = place[graph->list[e]], up; i != NONE && i < k; i = up) {
                up = root[i];
                root[i] = k;
                if (up == NONE)
                    parent[i] = k;
            }
    }
}

/* post[k]: the k-th node when children come right before their parents; child, beside and stack (n) are scratch. */
static void postorder(int n, const int *parent, int *post, int *child, int *beside, int *stack)
{
    int done = 0;
    for (int k = 0; k < n; k++)
        child[k] = NONE;
    for (int k = n - 1; k >= 0; k--)
        if (parent[k] != NONE) {
            beside[k] = child[parent[k]];
            child[parent[k]] = k;
        }
    for (int k = 0; k < n; k++) {
        if (parent[k] != NONE)
            continue;
        int top = 0;
        stack[0] = k;
        while (top >= 0) {
            const int i = stack[top], c = child[i];
            if (c == NONE) {
                post[done++] = i;
                top--;
            } else {
                child[i] = beside[c];
                stack[++top] = c;
            }
        }
    }
}

/* The columns of A in the new order: its rows, and where each given entry went; `mark` and `count` are scratch. */
static int place_entries(const SparsePattern *a, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns,
                         const int *place, ptrdiff_t *slot)
{
    const int n = a->n;
    ptrdiff_t *end = a->start, *where = malloc(((size_t)n + (size_t)m + 1) * sizeof *where), *sorted = where + n;
    if (!where)
        return -1;
    for (int k = 0; k <= n; k++)
        end[k] = 0;
    for (ptrdiff_t e = 0; e < m; e++) {
        const int i = place[rows[e]], j = place[columns[e]];
        end[(i > j ? i : j) + 1]++;
    }
    for (int k = 0; k < n; k++)
        end[k + 1] += end[k];
    for (int k = 0; k < n; k++)
        where[k] = end[k];
    for (ptrdiff_t e = 0; e < m; e++) {
        const int i = place[rows[e]], j = place[columns[e]];
        sorted[where[i > j ? i : j]++] = e;
    }
    ptrdiff_t kept = 0, from = 0;
    for (int k = 0; k < n; k++)
        where[k] = NONE;
    for (int k = 0; k < n; k++) {
        const ptrdiff_t to = end[k + 1], first = kept;
        end[k] = first;
        for (; from < to; from++) {
            const ptrdiff_t e = sorted[from];
            const int i = place[rows[e]], j = place[columns[e]], row = i > j ? j : i;
            if (where[row] < first) {
                where[row] = kept;
                a->row[kept++] = row;
            }
            slot[e] = where[row];
        }
    }
    end[n] = kept;
    free(where);
    return 0;
}

/* Where the columns of L start; `seen` and `count` (n) are scratch. */
static void count_fill(const SparsePattern *a, int *seen, int *count)
{
    for (int k = 0; k < a->n; k++) {
        seen[k] = k;
        count[k] = 0;
        for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++)
            for (int i = a->row[e]; seen[i] != k; i = a->parent[i]) {
                seen[i] = k;
                count[i]++;
            }
    }
    a->fill[0] = 0;
    for (int k = 0; k < a->n; k++)
        a->fill[k + 1] = a->fill[k] + count[k];
}

int sparse_analyse(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns, int block,
                   SparsePattern *a, ptrdiff_t *slot)
{
    int *scratch = malloc(((size_t)n * 6 + 1) * sizeof *scratch), failed = -1;
    if (!scratch)
        return -1;
    int *place = scratch, *s = scratch + n, *post = scratch + 2 * n, *t = scratch + 3 * n, *u = scratch + 4 * n;
    int *v = scratch + 5 * n;
    Graph graph = {0};
    a->n = n;
    a->block = block;
    if (!make_graph(n, m, rows, columns, place, &graph) && !minimum_degree(n, graph.start, graph.list, v)) {
        for (int k = 0; k < n; k++)
            place[v[k]] = k;
        eliminate_tree(n, &graph, v, place, a->parent, s);
        postorder(n, a->parent, post, s, t, u);
        for (int k = 0; k < n; k++)
            a->order[k] = v[post[k]];
        for (int k = 0; k < n; k++)
            place[a->order[k]] = k;
        eliminate_tree(n, &graph, a->order, place, a->parent, s);
        failed = place_entries(a, m, rows, columns, place, slot);
        if (!failed)
            count_fill(a, s, t);
    }
    free(graph.start);
    free(graph.list);
    free(scratch);
    return failed;
}
