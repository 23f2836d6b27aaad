// The net operations in plain C++. They are the oracle for the others, and are used on machines without AVX2.
#define FACETLESS_SCALAR_KERNEL 1
#include "render/kernels/net_kernel.h"
#include "render/kernels/net_kernel.inl.h"
