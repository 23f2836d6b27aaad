#include "render/baseline/mesh_writer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <new>
#include <utility>

#include "render/baseline/mesh_encoder.h"
#include "render/baseline/mesh_file.h"

namespace facetless {
namespace {

struct Suffix {
  const char* name;
  MeshFormat format;
};
constexpr Suffix kSuffixes[] = {{".glb", MeshFormat::kGlb},
                                {".stl", MeshFormat::kStl},
                                {".obj", MeshFormat::kObj},
                                {".3mf", MeshFormat::k3mf}};

template <typename Number>
void AppendShortest(std::string& text, Number number) {
  char digits[32];  // the longest double has 24 characters
  const auto [end, failed] = std::to_chars(std::begin(digits), std::end(digits), number);
  text.append(digits, end);
}

}  // namespace

Rgba ToRgba(const Color& color) {
  const auto byte = [](float share) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
  };
  return {byte(color.r), byte(color.g), byte(color.b), byte(color.a)};
}

std::string HexRgba(const Rgba& color) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (std::uint8_t byte : color) text += {kDigits[byte >> 4], kDigits[byte & 15]};
  if (color[3] == 255) text.resize(6);
  return text;
}

std::vector<Rgba> PlacedFaceColors(const MeshNode& node, const Model& model) {
  const Instance& instance = model.instances[model.InstanceOfPlacedFace(node.first_placed_face)];
  std::vector<Rgba> colors;
  for (std::uint32_t f = 0; f < model.parts[instance.part].faces.count; ++f)
    colors.push_back(ToRgba(model.PlacedFaceColor(instance.first_placed_face + f)));
  return colors;
}

void AppendNumber(std::string& text, double number) {
  AppendShortest(text, number);
}
void AppendNumber(std::string& text, float number) {
  AppendShortest(text, number);
}

Vec3 PlacedNormal(const Placement& placement, Vec3 normal) {
  // Multiply by the cofactors, which are the inverse transpose times the magnitude of the determinant.
  const auto& m = placement.m;
  const Vec3 rows[3] = {
      {m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  const Vec3 turned{Dot(Cross(rows[1], rows[2]), normal), Dot(Cross(rows[2], rows[0]), normal),
                    Dot(Cross(rows[0], rows[1]), normal)};
  return Normalized(placement.Determinant() < 0 ? -turned : turned);
}

Result<MeshFormat> MeshFormatFromPath(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  for (char& c : suffix)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  std::string names;
  for (const Suffix& known : kSuffixes) {
    if (suffix == known.name) return known.format;
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  return Error{ErrorCode::kBadUsage, "--out " + path + ": the suffix must name the format of the mesh: " +
                                         names + (suffix.empty() ? "" : "; not " + suffix)};
}

Result<std::vector<MeshOutput>> EncodeMesh(const Mesh& mesh, const Model& model, MeshFormat format,
                                           const std::string& stem) {
  if (!RefersToFacesOfModel(mesh, model))
    return Error{ErrorCode::kInternal, "the mesh to be written does not belong to the model"};
  try {
    if (format == MeshFormat::kObj) return EncodeObj(mesh, model, stem);
    auto bytes = format == MeshFormat::kGlb   ? EncodeGlb(mesh, model)
                 : format == MeshFormat::kStl ? EncodeStl(mesh, model)
                                              : Encode3mf(mesh, model);
    if (!bytes) return bytes.error();
    std::vector<MeshOutput> files;
    files.push_back({"", std::move(bytes).value()});
    return files;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, "the mesh is too large for this machine's memory"};
  }
}

}  // namespace facetless
