// The builds of NetOperations (nurbs/net_operations.h) for each instruction set. dispatch.h selects one.
#pragma once

#include "render/nurbs/net_operations.h"

namespace facetless {

namespace kernel_scalar {
extern const NetOperations kNets;
}
namespace kernel_avx2 {
extern const NetOperations kNets;
}

}  // namespace facetless
