// Fuzz target: the IGES text reader and its repair.
#include "import/iges_text.h"

#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(facetless::Text(data, size));
  const auto facts = facetless::ScanIges("fuzz.igs", bytes);
  // OpenSource, too, repairs only files that could be read.
  if (facts.ok() && !facts.value().cut_off) {
    facetless::RepairIges(bytes);
    // The repair may only lose blanks, and a repaired file must not need the same repair again.
    std::string again = bytes;
    const facetless::IgesRepair repair = facetless::RepairIges(again);
    facetless::Require(repair.reals == 0 && repair.wide_lines == 0 && again == bytes);
  }
  return 0;
}
