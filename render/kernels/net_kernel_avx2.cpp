// Operations on nets for AVX2, a point in one register. The build gives this file the target's flags.

#include "render/kernels/net_kernel.h"
#include "render/kernels/net_kernel.inl.h"
