// The net operations for AVX2, with a point in one register. The build compiles this file with the flags of
// the target.

#include "render/kernels/net_kernel.h"
#include "render/kernels/net_kernel.inl.h"
