// The samples that the project ships, and the expected results.
#pragma once

#include <cctype>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/files.h"

namespace facetless {

// Returns the names of CAD files in expected.json, "bracket.step", "broken/empty.step", or those of voxel files. Returns nothing if the file is
// missing: this function runs while a program is loaded and must not throw, and a test reports the missing
// file.
inline std::vector<std::string> SampleNames(bool voxels = false) {
  std::vector<std::string> names;
  std::ifstream file(Sample("expected.json"));
  const nlohmann::json expected = nlohmann::json::parse(file, nullptr, false);
  for (const auto& [name, value] : expected.items())
    if (value.contains("voxels") == voxels) names.push_back(name);
  return names;
}

// Turns the name into a valid name of a test.
inline std::string TestName(std::string name) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace facetless
