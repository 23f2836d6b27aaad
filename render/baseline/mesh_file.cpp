#include "render/baseline/mesh_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>
#include <vector>

#include "render/baseline/mesh_reader.h"

namespace facetless {
namespace {

// The size ratios that wrong units cause: powers of 10, and ratios of millimetres, inches, feet and metres.
constexpr double kUnitSlips[] = {10, 12, 25.4, 1000 / 25.4, 100, 304.8, 1000};
constexpr double kSlipTolerance = 0.05;  // tessellation, missing parts and loose boxes change sizes by less

struct Unit {
  const char* name;
  double millimetres;
};
constexpr Unit kUnits[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"ft", 304.8}};

bool About(double a, double b) {
  return std::fabs(a - b) <= kSlipTolerance * b;
}

// The axes and the unit of the file, from the options or else from the format. Error: kBadUsage.
Result<FileAxes> ResolveAxes(const MeshLoadOptions& options, FileAxes own) {
  if (!options.unit.empty()) {
    const auto unit = std::find_if(std::begin(kUnits), std::end(kUnits),
                                   [&](const Unit& known) { return options.unit == known.name; });
    if (unit == std::end(kUnits))
      return Error{ErrorCode::kBadUsage, "mesh unit '" + options.unit + "': there are mm, cm, m, in, ft"};
    own.unit_mm = unit->millimetres;
  }
  if (!options.up.empty()) {
    if (options.up != "y" && options.up != "z")
      return Error{ErrorCode::kBadUsage, "mesh up axis '" + options.up + "': there are y and z"};
    own.y_up = options.up == "y";
  }
  return own;
}

Result<std::vector<unsigned char>> ReadBytes(const std::string& path, const std::string& name,
                                             std::uint64_t limit) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    return Error{ErrorCode::kFileUnreadable,
                 name + ": " + (failed ? failed.message() : std::string("not a regular file"))};
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  if (failed) return Error{ErrorCode::kFileUnreadable, name + ": " + failed.message()};
  if (size > limit)
    return Error{ErrorCode::kLimitExceeded,
                 name + ": " + std::to_string(size) + " bytes; the limit is " + std::to_string(limit)};
  std::ifstream stream(path, std::ios::binary);
  std::vector<unsigned char> bytes(size);
  if (!stream || !stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return Error{ErrorCode::kFileUnreadable, name + ": " + std::strerror(errno)};
  return bytes;
}

std::string Times(double ratio) {
  char text[64];
  std::snprintf(text, sizeof text, "%.4g times as %s", ratio > 1 ? ratio : 1 / ratio,
                ratio > 1 ? "large" : "small");
  return text;
}

// The Frobenius norm of the linear part of a placement, which is √3 × the scale of a similarity.
double FrobeniusNorm(const Placement& placement) {
  double sum = 0;
  for (const auto& row : placement.m)
    for (int column = 0; column < 3; ++column) sum += row[column] * row[column];
  return std::sqrt(sum);
}

// Half the distance from `x` to the next float32.
double HalfUlp(float x) {
  return 0.5 * (static_cast<double>(std::nextafter(x, INFINITY)) - static_cast<double>(x));
}

}  // namespace

bool RefersToFacesOfModel(const Mesh& mesh, const Model& model) {
  if (!mesh.from_model) return false;
  const std::uint32_t placed = model.PlacedFaceCount();
  for (const MeshNode& node : mesh.nodes) {
    const MeshPart& part = mesh.parts[node.part];
    if (part.triangles.empty()) continue;
    if (node.first_placed_face >= placed) return false;
    const Instance& instance = model.instances[model.InstanceOfPlacedFace(node.first_placed_face)];
    const std::uint32_t highest =
        *std::max_element(part.face_of_triangle.begin(), part.face_of_triangle.end());
    if (instance.first_placed_face != node.first_placed_face ||
        highest >= model.parts[instance.part].faces.count)
      return false;
  }
  return true;
}

Placement FileToModel(FileAxes axes) {
  const double s = axes.unit_mm;
  if (axes.y_up) return {{{s, 0, 0, 0}, {0, 0, -s, 0}, {0, s, 0, 0}}};
  return {{{s, 0, 0, 0}, {0, s, 0, 0}, {0, 0, s, 0}}};
}

Placement Compose(const Placement& a, const Placement& b) {
  Placement product;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? a.m[row][3] : 0;
      for (int k = 0; k < 3; ++k) sum += a.m[row][k] * b.m[k][column];
      product.m[row][column] = sum;
    }
  return product;
}

Box3 MeshBounds(const Mesh& mesh) {
  Box3 bounds;
  for (const MeshNode& node : mesh.nodes)
    for (const auto& triangle : mesh.parts[node.part].triangles)
      for (std::uint32_t vertex : triangle) {
        const auto& p = mesh.parts[node.part].positions[vertex];
        bounds.Add(node.placement.Point({p[0], p[1], p[2]}));
      }
  return bounds;
}

std::uint64_t PlacedTriangleCount(const Mesh& mesh) {
  std::uint64_t count = 0;
  for (const MeshNode& node : mesh.nodes) count += mesh.parts[node.part].triangles.size();
  return count;
}

double PositionNoise(const Mesh& mesh) {
  std::vector<double> of_part;
  for (const MeshPart& part : mesh.parts) {
    float largest = 0;
    for (const auto& position : part.positions)
      for (float coordinate : position) largest = std::max(largest, std::fabs(coordinate));
    of_part.push_back(HalfUlp(largest));
  }
  double noise = 0;
  for (const MeshNode& node : mesh.nodes)
    noise = std::max(noise, of_part[node.part] * FrobeniusNorm(node.placement));
  return noise;
}

Result<void> CheckMeshSize(const Box3& mesh, double unit_mm, const Box3& model) {
  if (mesh.empty() || model.empty() || !(model.diagonal() > 0) || !(mesh.diagonal() > 0)) return {};

  // Look for a size ratio that a wrong unit explains.
  const double ratio = mesh.diagonal() / model.diagonal();
  const auto slipped = std::find_if(std::begin(kUnitSlips), std::end(kUnitSlips), [&](double slip) {
    return About(ratio, slip) || About(1 / ratio, slip);
  });
  if (slipped != std::end(kUnitSlips)) {
    const auto remedy = std::find_if(std::begin(kUnits), std::end(kUnits), [&](const Unit& unit) {
      return About(unit_mm / ratio, unit.millimetres);
    });
    return Error{ErrorCode::kUnitMismatch,
                 "the mesh is " + Times(ratio) + " as the model: its unit is probably another" +
                     (remedy == std::end(kUnits) ? std::string("; scale it, or give --mesh-unit")
                                                 : "; try --mesh-unit " + std::string(remedy->name))};
  }

  // Check for extents that match only with Y and Z exchanged.
  const Vec3 a = mesh.high - mesh.low, b = model.high - model.low;
  const double slack = kSlipTolerance * model.diagonal();
  const auto near = [&](double x, double y) { return std::fabs(x - y) <= slack; };
  if (near(a.x, b.x) && near(a.y, b.z) && near(a.z, b.y) && !(near(a.y, b.y) && near(a.z, b.z)))
    return Error{ErrorCode::kUnitMismatch,
                 "the mesh has the model's size with Y and Z exchanged; try the other one of --mesh-up y, "
                 "--mesh-up z"};
  return {};
}

Result<Mesh> LoadMesh(const std::string& path, const MeshLoadOptions& options, const Model* model) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (!(options.crease_deg >= 0 && options.crease_deg <= 180))
    return Error{ErrorCode::kBadUsage, "the crease angle must lie between 0 and 180 degrees"};
  const Result<std::vector<unsigned char>> bytes = ReadBytes(path, name, options.max_file_bytes);
  if (!bytes.ok()) return bytes.error();

  // Choose the reader by content.
  const bool glb = LooksLikeGlb(bytes.value());
  if (!glb && !LooksLikeStl(bytes.value()))
    return Error{ErrorCode::kFormatUnknown,
                 name + ": neither glTF binary (.glb) nor STL; export the mesh as one of them"};
  const Result<FileAxes> axes = ResolveAxes(options, glb ? FileAxes{1000, true} : FileAxes{1, false});
  if (!axes.ok()) return axes.error();
  Result<Mesh> mesh = Error{};
  try {
    mesh = glb ? ReadGlb(bytes.value(), name, axes.value(), options)
               : ReadStl(bytes.value(), name, axes.value(), options);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, name + ": too large for this machine's memory"};
  }
  if (!mesh.ok() || model == nullptr) return mesh;

  // Compare with the model.
  const Result<void> size = CheckMeshSize(MeshBounds(mesh.value()), axes.value().unit_mm, model->bounds);
  if (!size.ok()) return Error{size.error().code, name + ": " + size.error().message};
  mesh.value().from_model = RefersToFacesOfModel(mesh.value(), *model);
  return mesh;
}

std::size_t TrianglesAgainstNormals(const Mesh& mesh) {
  std::size_t with = 0, against = 0;
  for (const MeshPart& part : mesh.parts) {
    const auto vector = [](const std::array<float, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
    for (const auto& t : part.triangles) {
      const Vec3 a = vector(part.positions[t[0]]), b = vector(part.positions[t[1]]),
                 c = vector(part.positions[t[2]]);
      const Vec3 normals =
          vector(part.normals[t[0]]) + vector(part.normals[t[1]]) + vector(part.normals[t[2]]);
      const double along = Dot(Cross(b - a, c - a), normals);
      with += along > 0;
      against += along < 0;
    }
  }
  return against > 9 * with ? against : 0;
}

}  // namespace facetless
