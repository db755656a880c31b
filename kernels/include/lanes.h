/* LANES doubles in vector registers, as GCC and Clang have them; AT and OF take them from memory. They may
   partly overlap (may_alias); without this attribute GCC assumes that two are identical or disjoint, and loses stores. */
#pragma once

#define LANES 8
#define AT(p) (*(Lanes *)(p))
#define OF(p) (*(const Lanes *)(p))

typedef double Lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));
