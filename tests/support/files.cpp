#include "tests/support/files.h"

#include <cstdlib>

namespace facetless {

std::filesystem::path SourceRoot() {
  const char* root = std::getenv("FACETLESS_SOURCE");
  return root != nullptr ? std::filesystem::path(root)
                         : std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
}

std::string Sample(const std::string& name) {
  return (SourceRoot() / "samples" / name).string();
}

std::string CadFile(const std::string& name) {
  const char* folder = std::getenv("FACETLESS_CAD");
  const std::filesystem::path path =
      (folder != nullptr ? std::filesystem::path(folder) : SourceRoot() / "../shared/cad") / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

}  // namespace facetless
