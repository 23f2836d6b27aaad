// Fuzz target: the options of a request, and the cameras in them.
#include "server/options/options.h"

#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto json = nlohmann::json::parse(data, data + size, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return 0;
  const auto options = facetless::ParseOptions(json);
  if (!options.ok()) {
    facetless::Require(options.error().code == facetless::ErrorCode::kBadUsage);
    return 0;
  }
  facetless::Box3 bounds;
  bounds.Add({0, 0, 0});
  bounds.Add({10, 20, 30});
  const auto cameras = facetless::ResolveCameras(options.value(), bounds);
  if (!cameras.ok()) return 0;
  for (const facetless::Camera& camera : cameras.value())
    (void)facetless::MakeFrame(camera, bounds.diagonal());
  return 0;
}
