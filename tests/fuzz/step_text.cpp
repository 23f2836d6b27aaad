// Fuzz target: the STEP text reader, which is ours and sees every byte first.
#include "import/step_text.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = facetless::Text(data, size);
  const auto facts = facetless::ScanStep("fuzz.step", bytes);
  facetless::Require(facts.ok() ? facts.value().complete_bytes <= size : !facts.error().message.empty());
  facetless::DecodeStepText(bytes);
  return 0;
}
