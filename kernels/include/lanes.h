/* LANES numbers, in registers where the compiler has a way to say so. */
#ifndef MESHONET_LANES_H
#define MESHONET_LANES_H

#define LANES 8

#if defined(__GNUC__)
typedef double Lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));
#define LOAD(p) (*(const Lanes *)(p))
#define STORE(p, v) (*(Lanes *)(p) = (v))
#define ADD_PRODUCT(sum, a, b) ((sum) += (a) * (b))
#else
typedef struct { double at[LANES]; } Lanes;
#define LOAD(p) (*(const Lanes *)(p))
#define STORE(p, v) (*(Lanes *)(p) = (v))
#define ADD_PRODUCT(sum, a, b) do { for (int v_ = 0; v_ < LANES; v_++) (sum).at[v_] += (a) * (b).at[v_]; } while (0)
#endif

#endif
