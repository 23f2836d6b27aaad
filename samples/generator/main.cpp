// facetless-samples FOLDER: writes the sample CAD files and expected.json into FOLDER.

#include <sys/personality.h>
#include <unistd.h>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "samples/generator/assembly.h"
#include "samples/generator/broken.h"
#include "samples/generator/expected.h"
#include "samples/generator/shapes.h"
#include "samples/generator/voxels.h"
#include "samples/generator/writer.h"

namespace {

namespace fs = std::filesystem;
using facetless::samples::Measure;
using facetless::samples::WriteIges;
using facetless::samples::WriteStep;

nlohmann::ordered_json WriteAssembly(const fs::path& folder) {
  const Handle(TDocStd_Document) document = facetless::samples::Assembly();
  const std::string path = (folder / "assembly.step").string();
  WriteStep(document, "stack", path);
  TDF_LabelSequence roots;
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  shapes->GetFreeShapes(roots);
  return Measure(shapes->GetShape(roots.Value(1)), path);
}

void WriteAll(const fs::path& folder) {
  const std::map<std::string, std::function<TopoDS_Shape()>> step_samples = {
      {"bracket", facetless::samples::Bracket}, {"wavy_sheet", facetless::samples::WavySheet},
      {"teapot", facetless::samples::Teapot},   {"sphere", facetless::samples::Sphere},
      {"cone", facetless::samples::Cone},       {"torus", facetless::samples::Torus},
      {"blade", facetless::samples::Blade},     {"freeform", facetless::samples::Freeform},
      {"vase", facetless::samples::Vase},
  };
  nlohmann::ordered_json expected;
  fs::create_directories(folder);
  for (const auto& [name, make] : step_samples) {
    std::cout << name << std::endl;
    const TopoDS_Shape shape = make();
    const std::string path = (folder / (name + ".step")).string();
    WriteStep(shape, name, path);
    expected[name + ".step"] = Measure(shape, path);
  }
  std::cout << "assembly" << std::endl;
  expected["assembly.step"] = WriteAssembly(folder);
  std::cout << "trimmed" << std::endl;
  const TopoDS_Shape trimmed = facetless::samples::TrimmedFaces();
  WriteIges(trimmed, "trimmed", (folder / "trimmed.iges").string());
  expected["trimmed.iges"] = Measure(trimmed, (folder / "trimmed.iges").string());

  std::cout << "terrain and head" << std::endl;
  expected["terrain.vxl"] = facetless::samples::WriteTerrain(folder);
  expected["head.nrrd"] = facetless::samples::WriteHead(folder);

  facetless::samples::WriteBroken(folder);
  for (const char* name : {"truncated.step", "nan.step", "wrong_type.step", "empty.step", "mesh.stl"}) {
    expected[std::string("broken/") + name] = {{"exit", 4}};
  }
  std::ofstream out(folder / "expected.json");
  out << expected.dump(2) << "\n";
  if (!out.flush()) throw std::runtime_error("cannot write expected.json");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: facetless-samples FOLDER\n";
    return 64;
  }
  // OpenCASCADE writes colours in the order of a map that is hashed by address. Without address randomisation,
  // the file is always the same.
  if ((personality(0xffffffff) & ADDR_NO_RANDOMIZE) == 0 && personality(ADDR_NO_RANDOMIZE) != -1) {
    execv("/proc/self/exe", argv);
  }
  // OpenCASCADE reports every step to standard output.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    WriteAll(argv[1]);
  } catch (const Standard_Failure& failure) {
    std::cerr << "facetless-samples: " << failure.GetMessageString() << "\n";
    return 1;
  } catch (const std::exception& failure) {
    std::cerr << "facetless-samples: " << failure.what() << "\n";
    return 1;
  }
  return 0;
}
