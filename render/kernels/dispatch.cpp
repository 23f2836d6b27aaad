#include "render/kernels/dispatch.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include <cstdlib>

#include "render/kernels/net_kernel.h"

namespace facetless {
namespace {

#if defined(__x86_64__)
// Asks the processor directly, because __builtin_cpu_supports of clang 14 does not know this feature.
bool SupportsF16c() {
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  return __get_cpuid(1, &eax, &ebx, &ecx, &edx) != 0 && (ecx & bit_F16C) != 0;
}
#endif

}  // namespace

std::vector<Kernels> AvailableKernels() {
  // List the kernels, narrowest first. Each requires all features that Highway's target of that name uses.
  std::vector<Kernels> available{{"scalar", kernel_scalar::TraceTile, kernel_scalar_float::TraceTile,
                                  &kernel_scalar::kNets, kernel_scalar::VisitRayBlocks}};
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && SupportsF16c();
  if (avx2)
    available.push_back({"avx2", kernel_avx2::TraceTile, kernel_avx2_float::TraceTile, &kernel_avx2::kNets,
                         kernel_avx2::VisitRayBlocks});
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd")) {
    // A point of a net fills an AVX2 register, and so does a row of a ray block, so these are used here, too.
    available.push_back({"avx512", kernel_avx512::TraceTile, kernel_avx512_float::TraceTile,
                         &kernel_avx2::kNets, kernel_avx2::VisitRayBlocks});
  }
#endif
  return available;
}

namespace {

Result<Kernels> Choose() {
  const std::vector<Kernels> available = AvailableKernels();
  const char* forced = std::getenv("FACETLESS_ISA");
  if (!forced || !*forced) return available.back();
  std::string names;
  for (const Kernels& kernels : available) {
    if (kernels.isa == forced) return kernels;
    names += (names.empty() ? "" : ", ") + kernels.isa;
  }
  return Error{ErrorCode::kBadUsage,
               "FACETLESS_ISA=" + std::string(forced) + " is not available here; use one of: " + names};
}

}  // namespace

const Result<Kernels>& ActiveKernels() {
  static const Result<Kernels> kernels = Choose();
  return kernels;
}

}  // namespace facetless
