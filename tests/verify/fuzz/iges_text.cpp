// Fuzz target: the IGES text reader and its repair.
#include "import/iges_text.h"

#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(facetless::Text(data, size));
  const auto facts = facetless::ScanIges("fuzz.igs", bytes);
  // As OpenSource does: repairs are for files that could be read.
  if (facts.ok() && !facts.value().cut_off) {
    facetless::RepairIges(bytes);
    // Lost between the two are only blanks: nothing needs the same repair twice.
    std::string again = bytes;
    const facetless::IgesRepair repair = facetless::RepairIges(again);
    facetless::Require(repair.reals == 0 && repair.wide_lines == 0 && again == bytes);
  }
  return 0;
}
