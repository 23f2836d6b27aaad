// The visit of ray blocks for AVX2 with FMA. The build compiles this file with the flags of the target.
#include "render/kernels/ray_blocks.inl.h"
