/* LANES doubles in vector registers, as GCC and Clang have them; AT and OF take them from memory. They may overlap each
   other in part (may_alias): without that, GCC takes two for one or for apart, and loses what was written. */
#pragma once

#define LANES 8
#define AT(p) (*(Lanes *)(p))
#define OF(p) (*(const Lanes *)(p))

typedef double Lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));
