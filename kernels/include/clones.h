/* One build for all x86-64 processors: the loader selects the variant of a function for the processor.
   Elsewhere (other processors, other compilers, make sanitize) it is plain C. */
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && __GNUC__ >= 12 && \
    !defined(__SANITIZE_ADDRESS__)
#define MESHONET_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define MESHONET_CLONES
#endif

#define MESHONET_INLINE static inline __attribute__((always_inline))

/* Before a loop whose rounds do not depend on each other: GCC loses `restrict` in inlined functions. */
#if defined(__GNUC__) && !defined(__clang__)
#define MESHONET_INDEPENDENT _Pragma("GCC ivdep")
#else
#define MESHONET_INDEPENDENT
#endif
