// An IGES file as text: what it declares, and the repair of reals that are written as integers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/result.h"

namespace facetless {

struct IgesEntity {
  int type = 0;            // 128, 144, …
  int directory = 0;       // sequence number of its first directory line: "D57"
  bool dependent = false;  // physically or logically subordinate to another one
};

struct IgesFacts {
  std::vector<IgesEntity> entities;
  std::vector<IgesEntity> without_data;  // those of `entities` whose parameters are missing or do not end
  bool cut_off = false;                  // ends, or is damaged, before the last section
};

// Reads the directory. Errors: kFormatBroken (no directory or no parameters, or an entity that claims more
// values than the file has bytes or is made of itself; names the entity), kNotFinite (a number that is NaN,
// infinite or beyond 1e150; names the entity).
Result<IgesFacts> ScanIges(const std::string& name, std::string_view bytes);

struct IgesRepair {
  std::uint64_t reals = 0;       // integers where reals belong
  std::uint64_t wide_lines = 0;  // lines whose data go beyond column 64
};

// Writes "1." for "1" wherever the entity's definition asks for a real, and lays out again data that leave
// their columns: OpenCASCADE drops such entities. Leaves `bytes` alone if there are none.
IgesRepair RepairIges(std::string& bytes);

}  // namespace facetless
