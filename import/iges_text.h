// An IGES file as text: what it declares, and the repair of reals that are written as integers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/model/result.h"

namespace facetless {

struct IgesEntity {
  int type = 0;            // 128, 144, …
  int directory = 0;       // sequence number of its first directory line: "D57"
  bool dependent = false;  // physically or logically subordinate to another one
};

struct IgesFacts {
  std::vector<IgesEntity> entities;
};

// Reads the directory. Error: kFormatBroken (no directory section, a line that is not 80 columns wide, or an entity that claims
// more values than the file has bytes; names the entity).
Result<IgesFacts> ScanIges(const std::string& name, std::string_view bytes);

// Writes "1." for "1" wherever the entity's definition asks for a real: OpenCASCADE drops such entities. Returns how many
// numbers changed; 0 leaves `bytes` alone. Requires that ScanIges finds no error.
std::uint64_t RepairIgesReals(std::string& bytes);

}  // namespace facetless
