#include "import/readers.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <OSD.hxx>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "import/scaled_shapes.h"

namespace facetless {
namespace {

// Defines how STEP shapes are healed, by HealDocument (heal.h) and by other STEP readers in this process
// (tests have some). The settings are OpenCASCADE's, except that one repair is off: it takes four fifths of
// the time of a large file and finds nothing to do in sound ones. StepReader's transfer runs the empty
// sequence.
constexpr char kStepResource[] =
    "FromSTEP.exec.op : FixShape\n"
    "FromSTEP.FixShape.Tolerance3d : &Runtime.Tolerance\n"
    "FromSTEP.FixShape.MaxTolerance3d : &Runtime.MaxTolerance\n"
    "FromSTEP.FixShape.MinTolerance3d : 1.e-7\n"
    "FromSTEP.FixShape.FixNonAdjacentIntersectingEdgesMode : 0\n"
    "Unhealed.exec.op :\n";

}  // namespace

void PrepareOpenCascade(const std::string& scratch) {
  // Turn signals of faults into exceptions, which the readers catch.
  OSD::SetSignal(false);
  // Standard output is reserved for the importer's JSON.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  std::ofstream(scratch + "/STEP") << kStepResource;
  setenv("CSF_STEPDefaults", scratch.c_str(), 1);
}

std::string UnitName(double mm, const std::string& written) {
  struct Unit {
    double mm;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1, "millimetre"},      {10, "centimetre"}, {1000, "metre"}, {1e6, "kilometre"},
                             {1e-3, "micrometre"},   {25.4, "inch"},     {304.8, "foot"}, {0.0254, "mil"},
                             {2.54e-5, "microinch"}, {1609344, "mile"}};
  for (const Unit& unit : kUnits) {
    // Conversion factors in files may have as few as six digits.
    if (std::fabs(mm - unit.mm) <= 1e-6 * unit.mm) return unit.name;
  }
  return written.empty() ? std::to_string(mm) + " millimetres" : written;
}

namespace {

// If the file has no unit, reports which unit is assumed. If the caller gave a unit, applies it.
void SettleUnit(double unit_mm, CadDocument& document) {
  ImportInfo& info = document.info;
  if (unit_mm > 0) {
    const std::string name = UnitName(unit_mm, "");
    info.warnings.push_back("The file's unit is " +
                            (info.unit.empty() ? std::string("not known") : info.unit) +
                            "; the requested unit, " + name + ", is used instead.");
    if (unit_mm != info.unit_mm) ScaleDocument(unit_mm / info.unit_mm, document);
    info.unit = name;
    info.unit_mm = unit_mm;
  } else if (info.unit.empty()) {
    info.warnings.push_back(
        "The file has no length unit that can be read, so millimetres are assumed; set another unit with "
        "--unit.");
  }
}

}  // namespace

Result<CadDocument> ReadDocument(const SourceFile& source, StageProgress progress, double unit_mm) {
  Result<CadDocument> document = source.format == CadFormat::kStep   ? ReadStep(source, progress)
                                 : source.format == CadFormat::kIges ? ReadIges(source, progress)
                                                                     : ReadBrep(source, progress);
  if (!document.ok()) return document;
  ImportInfo& info = document.value().info;
  info.file = source.name;
  info.sha256 = source.sha256;
  SettleUnit(unit_mm, document.value());
  info.warnings.insert(info.warnings.begin(), source.repairs.begin(), source.repairs.end());
  return document;
}

}  // namespace facetless
