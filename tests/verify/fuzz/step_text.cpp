// Fuzz target: the STEP text reader and its repairs. They are our own code, and they are the first to see
// every byte.
#include "import/step_text.h"

#include "import/step_repair.h"

#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = facetless::Text(data, size);
  const auto facts = facetless::ScanStep("fuzz.step", bytes);
  facetless::Require(facts.ok() ? facts.value().complete_bytes <= size : !facts.error().message.empty());
  facetless::DecodeStepText(bytes);
  if (!facts.ok()) return 0;
  // A repaired file is read like any other file.
  const facetless::StepRepair repair = facetless::RepairStep(bytes);
  if (repair.changed && repair.refusal.empty()) facetless::RepairStep(repair.bytes);
  std::string open(bytes);
  facetless::FlattenScopes(open);
  return 0;
}
