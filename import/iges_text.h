// Reads an IGES file as text: finds what it declares, and repairs reals that are written as integers.
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
  bool dependent = false;  // the entity is physically or logically subordinate to another one
};

struct IgesFacts {
  std::vector<IgesEntity> entities;
  std::vector<IgesEntity> without_data;  // those of `entities` whose parameters are missing or have no end
  bool cut_off = false;                  // the file ends, or is damaged, before its last section
};

// Reads the directory. Errors: kFormatBroken (there is no directory or there are no parameters; an entity
// claims more values than the file has bytes, or refers to itself; the message names the entity), kNotFinite
// (a number is NaN, infinite or beyond 1e150; the message names the entity).
Result<IgesFacts> ScanIges(const std::string& name, std::string_view bytes);

struct IgesRepair {
  std::uint64_t reals = 0;       // integers where reals are required
  std::uint64_t wide_lines = 0;  // lines whose data extend beyond column 64
};

// Writes "1." instead of "1" wherever the entity's definition requires a real, and lays out again the data
// that extend beyond their columns. OpenCASCADE drops such entities. If there are none, `bytes` does not
// change.
IgesRepair RepairIges(std::string& bytes);

}  // namespace facetless
