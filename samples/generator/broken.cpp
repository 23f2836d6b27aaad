#include "samples/generator/broken.h"

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace facetless::samples {
namespace {

namespace fs = std::filesystem;

std::string ReadText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

// Replaces the first coordinate of the first point of the data section by NAN, as a careless exporter writes
// it.
std::string WithNan(std::string text) {
  const std::size_t point = text.find("CARTESIAN_POINT('',(");
  const std::size_t begin = text.find(",(", point) + 2, end = text.find(',', begin);
  if (point == std::string::npos) throw std::runtime_error("no point in the sound file");
  return text.replace(begin, end - begin, "NAN");
}

}  // namespace

void WriteBroken(const fs::path& folder) {
  const std::string cone = ReadText(folder / "cone.step");
  const fs::path broken = folder / "broken";
  fs::create_directories(broken);

  WriteText(broken / "truncated.step", cone.substr(0, cone.size() / 2));
  WriteText(broken / "nan.step", WithNan(cone));
  WriteText(broken / "empty.step", "");
  WriteText(
      broken / "wrong_type.step",
      "<!DOCTYPE html>\n<html><head><title>404 Not Found</title></head>\n"
      "<body><h1>Not Found</h1><p>The file bracket.step was not found on this server.</p></body></html>\n");
  WriteText(
      broken / "mesh.stl",
      "solid triangle\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
      "  endloop\n endfacet\nendsolid triangle\n");
}

}  // namespace facetless::samples
