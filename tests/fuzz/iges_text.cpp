// Fuzz target: the IGES text reader and its repair.
#include "import/iges_text.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(facetless::Text(data, size));
  const auto facts = facetless::ScanIges("fuzz.igs", bytes);
  // As OpenSource does: repairs are for files that could be read.
  if (facts.ok() && !facts.value().cut_off) {
    const facetless::IgesRepair repair = facetless::RepairIges(bytes);
    // What was repaired can be read, and needs no further repair.
    if (repair.reals > 0 || repair.wide_lines > 0)
      facetless::Require(facetless::ScanIges("fuzz.igs", bytes).ok());
  }
  return 0;
}
