// Operations on nets in plain C++: the oracle, and the choice of machines without wide vectors.
#define FACETLESS_SCALAR_KERNEL 1
#include "render/kernels/net_kernel.h"
#include "render/kernels/net_kernel.inl.h"
