#include "server/base/version.h"

#include <algorithm>
#include <thread>

#include "render/trace/direct.h"

namespace facetless {

std::string Version() {
  return FACETLESS_VERSION;
}

nlohmann::json ProgramJson(int threads) {
  const auto isa = ActiveIsa();
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return {{"version", Version()},
          {"build", FACETLESS_BUILD},
          {"isa", isa.ok() ? nlohmann::json(isa.value()) : nlohmann::json(nullptr)},
          {"threads", threads > 0 ? threads : cores}};
}

}  // namespace facetless
