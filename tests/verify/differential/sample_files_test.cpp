// Reads the committed sample files with OpenCASCADE: they must agree with samples/expected.json, and its
// numbers must agree with closed forms where there are any.

#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/files.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json Expected() {
  return json::parse(std::ifstream(Sample("expected.json")));
}

TopoDS_Shape ReadShape(const fs::path& path) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader step;
  IGESControl_Reader iges;
  XSControl_Reader& reader = path.extension() == ".iges" ? static_cast<XSControl_Reader&>(iges) : step;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return {};
  reader.TransferRoots();
  return reader.OneShape();
}

struct Measured {
  int faces = 0, solids = 0, closed_solids = 0;
  double area = 0, volume = 0;
};

Measured Measure(const TopoDS_Shape& shape) {
  Measured measured;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) ++measured.faces;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    ++measured.solids;
    bool closed = true;
    for (TopExp_Explorer shell(solid.Current(), TopAbs_SHELL); shell.More(); shell.Next()) {
      closed = closed && BRep_Tool::IsClosed(shell.Current());
    }
    measured.closed_solids += closed ? 1 : 0;
    GProp_GProps properties;
    BRepGProp::VolumeProperties(solid.Current(), properties, 1e-9, false, true);
    measured.volume += properties.Mass();
  }
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-9, true);
  measured.area = properties.Mass();
  return measured;
}

TEST(SampleFiles, HoldWhatWasMade) {
  const json all = Expected();
  int sound = 0;
  for (const auto& [name, expected] : all.items()) {
    if (!expected.contains("faces")) continue;
    SCOPED_TRACE(name);
    ++sound;
    const TopoDS_Shape shape = ReadShape(Sample(name));
    ASSERT_FALSE(shape.IsNull());
    EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
    const Measured measured = Measure(shape);
    EXPECT_EQ(measured.faces, expected["faces"].get<int>());
    EXPECT_EQ(measured.solids, expected["solids"].get<int>());
    EXPECT_EQ(measured.closed_solids, expected["closed_solids"].get<int>());
    // The file has twelve decimal digits, and the integration is asked for 1e-9.
    EXPECT_NEAR(measured.area, expected["area_mm2"].get<double>(), 1e-7 * measured.area);
    EXPECT_NEAR(measured.volume, expected["volume_mm3"].get<double>(), 1e-7 * measured.volume);
  }
  EXPECT_GE(sound, 10);
}

TEST(SampleFiles, MeasuresAreTheClosedForms) {
  const json expected = Expected();
  const auto check = [&](const char* name, double area, double volume) {
    EXPECT_NEAR(expected[name]["area_mm2"].get<double>(), area, 1e-9 * area) << name;
    EXPECT_NEAR(expected[name]["volume_mm3"].get<double>(), volume, 1e-9 * volume) << name;
  };
  check("sphere.step", 4 * M_PI * 10 * 10, 4.0 / 3 * M_PI * 1000);
  check("cone.step", M_PI * 10 * (10 + std::hypot(10, 20)), M_PI * 10 * 10 * 20 / 3);
  check("torus.step", 4 * M_PI * M_PI * 20 * 6, 2 * M_PI * M_PI * 20 * 6 * 6);
}

}  // namespace
}  // namespace facetless
