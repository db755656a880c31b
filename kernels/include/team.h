/* Threads that work on the same arrays together: `team_run` calls `work(data, member)` on each; `team_wait` is a
   barrier. For equal bits with any number of threads, shares are whole rows or chunks of a fixed size, and one thread
   adds sums over these in order. On Windows a team is one thread. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#ifndef _WIN32
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#endif

#define TEAM_MOST 64 /* threads */

typedef struct Team Team;
typedef struct {
    int rank, size; /* this thread, and how many there are */
    Team *team;
} Member;
typedef void (*TeamWork)(void *data, Member member);

#ifdef _WIN32
struct Team {
    int size;
    double *rooms;
    size_t each;
};
static inline void team_wait(Member member) { (void)member; }
static inline void team_start(int threads, TeamWork work, void *data, double *rooms, size_t each)
{
    Team team = {1, rooms, each};
    (void)threads;
    work(data, (Member){0, 1, &team});
}
#else
struct Team {
    int size;
    double *rooms;
    size_t each;
    atomic_int come, round;
    TeamWork work;
    void *data;
};

static inline void team_wait(Member member)
{
    Team *team = member.team;
    if (team->size < 2)
        return;
    int round = atomic_load(&team->round);
    if (atomic_fetch_add(&team->come, 1) + 1 == team->size) {
        atomic_store(&team->come, 0);
        atomic_store(&team->round, round + 1);
        return;
    }
    for (int spins = 0; atomic_load_explicit(&team->round, memory_order_acquire) == round; spins++)
        if (spins > 4096)
            sched_yield();
}

typedef struct {
    Team *team;
    int rank;
} TeamEntry;

static void *team_enter(void *entry)
{
    TeamEntry *own = entry;
    while (atomic_load_explicit(&own->team->round, memory_order_acquire) < 0) /* how many are we? */
        sched_yield();
    own->team->work(own->team->data, (Member){own->rank, own->team->size, own->team});
    return NULL;
}

/* Runs `work` on `threads` threads, this one among them; on fewer where no more can be started. */
static inline void team_start(int threads, TeamWork work, void *data, double *rooms, size_t each)
{
    pthread_t others[TEAM_MOST];
    TeamEntry entries[TEAM_MOST];
    Team team = {.work = work, .data = data, .rooms = rooms, .each = each};
    int started = 1;
    atomic_init(&team.come, 0);
    atomic_init(&team.round, -1);
    for (; started < threads && started < TEAM_MOST; started++) {
        entries[started] = (TeamEntry){&team, started};
        if (pthread_create(&others[started], NULL, team_enter, &entries[started]))
            break;
    }
    team.size = started;
    atomic_store(&team.round, 0);
    entries[0] = (TeamEntry){&team, 0};
    team_enter(&entries[0]);
    for (int k = 1; k < started; k++)
        pthread_join(others[k], NULL);
}
#endif

static inline void team_run(int threads, TeamWork work, void *data) { team_start(threads, work, data, NULL, 0); }

/* As team_run, with room for `each` doubles of every thread, its team_room. Returns 0, or -1 without memory. */
static inline int team_run_in_rooms(int threads, size_t each, TeamWork work, void *data)
{
    double *rooms = malloc(each * (size_t)(threads < TEAM_MOST ? threads : TEAM_MOST) * sizeof *rooms);
    if (rooms != NULL)
        team_start(threads, work, data, rooms, each);
    free(rooms);
    return rooms != NULL ? 0 : -1;
}

static inline double *team_room(Member member) { return member.team->rooms + (size_t)member.rank * member.team->each; }

/* Add to a count that all threads have. */
static inline void team_add(int64_t *total, int64_t count)
{
#ifdef _WIN32
    *total += count;
#else
    __atomic_fetch_add(total, count, __ATOMIC_RELAXED);
#endif
}

typedef struct {
    ptrdiff_t first, last; /* the last is not in it */
} Range;

/* This thread's of `count` things. */
static inline Range team_share(ptrdiff_t count, Member member)
{
    return (Range){count * member.rank / member.size, count * (member.rank + 1) / member.size};
}

/* NAME: what a team does to a T, ROWS(task, first, last) by each member for its share of COUNT things. */
#define TEAM_ROWS(NAME, T, COUNT, ROWS)                \
    static void NAME(void *data, Member member)        \
    {                                                  \
        const T *task = data;                          \
        const Range own = team_share(COUNT, member);   \
        ROWS(task, own.first, own.last);               \
    }
