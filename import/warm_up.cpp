#include "import/warm_up.h"

#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <fstream>
#include <string>

#include "generated/import/warm_up_part.h"
#include "import/convert.h"
#include "import/mesh_file.h"
#include "import/readers.h"
#include "import/scratch.h"
#include "import/source_file.h"
#include "render/base/parallel.h"
#include "render/model/model_file.h"

namespace facetless {

namespace {

void ImportPart() {
  const Scratch scratch;
  if (scratch.path().empty()) return;
  try {
    OCC_CATCH_SIGNALS
    PrepareOpenCascade(scratch.path());
    const std::string part = scratch.path() + "/part.step";
    std::ofstream(part, std::ios::binary) << kWarmUpPart;
    const Result<SourceFile> source = OpenSource(part, scratch.path());
    if (!source.ok()) return;
    Result<CadDocument> document = ReadDocument(
        source.value(), [](const char*, double) {}, 0);
    if (!document.ok()) return;
    Result<Conversion> conversion = Convert(std::move(document.value()), [](double) {});
    if (!conversion.ok() || !WriteModel(conversion.value().model, scratch.path() + "/model.flm").ok()) return;
    (void)WriteMesh(conversion.value(), {conversion.value().model.Diagonal() / 100, 20},
                    scratch.path() + "/mesh.glb", [](double) {});
  } catch (const Standard_Failure&) {
    return;
  }
}

}  // namespace

void WarmUp() {
  // A process that has more than one thread cannot fork safely.
  RunWithThreads(1, ImportPart);
}

}  // namespace facetless
