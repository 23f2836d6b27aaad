#include "import/mesh_file.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <TopoDS_Compound.hxx>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "import/curve_pieces.h"
#include "import/memory_gauge.h"
#include "import/surface_patches.h"

#include <tiny_gltf.h>

namespace facetless {
namespace {

struct FaceMesh {
  std::vector<Vec3> positions, normals;  // in the part's frame
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Orients normals and fills in missing ones. Where a parameter line has collapsed to a point, the exact
// normal is known only up to its sign, and the facets around the node decide. Where there is no exact normal,
// the facets' normal is used.
void FinishNormals(const std::vector<bool>& unsigned_normal, FaceMesh& mesh) {
  std::vector<Vec3> facets(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    const Vec3 a = mesh.positions[triangle[0]], b = mesh.positions[triangle[1]],
               c = mesh.positions[triangle[2]];
    for (std::uint32_t node : triangle) facets[node] = facets[node] + Cross(b - a, c - a);
  }
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (Length(mesh.normals[i]) == 0) mesh.normals[i] = Normalized(facets[i]);
    if (unsigned_normal[i] && Dot(mesh.normals[i], facets[i]) < 0) mesh.normals[i] = -mesh.normals[i];
    // A node without a facet still needs a unit vector.
    if (Length(mesh.normals[i]) == 0) mesh.normals[i] = {0, 0, 1};
  }
}

// Returns the surface's unit normal at (u, v), or zero if it has none. If one derivative vanishes, the mixed
// derivative replaces it; the normal's sign is then unknown (*sign_unknown).
Vec3 NormalAt(const GeomAdaptor_Surface& surface, gp_Pnt2d uv, const gp_Trsf& placement, bool* sign_unknown) {
  gp_Pnt point;
  gp_Vec du, dv, duu, dvv, duv;
  surface.D2(uv.X(), uv.Y(), point, du, dv, duu, dvv, duv);
  // After cancellation, a vanishing derivative still has noise of this size.
  const double collapsed = 1e-10 * std::fmax(du.Magnitude(), dv.Magnitude());
  *sign_unknown = !(du.Magnitude() > collapsed) || !(dv.Magnitude() > collapsed);
  if (!(du.Magnitude() > collapsed)) du = duv;
  if (!(dv.Magnitude() > collapsed)) dv = duv;
  du.Transform(placement);
  dv.Transform(placement);
  return Normalized(Cross(ToVec3(du.XYZ()), ToVec3(dv.XYZ())));
}

// Returns whether the file's float32 can hold the position relative to any centre. OpenCASCADE may mesh faces
// of damaged files to infinity.
bool IsStorable(const Vec3& position) {
  constexpr double kGreatest = std::numeric_limits<float>::max() / 4;
  return std::fabs(position.x) <= kGreatest && std::fabs(position.y) <= kGreatest &&
         std::fabs(position.z) <= kGreatest;
}

// Returns the mesh of a face. It has no triangles if the face has none that can be stored.
FaceMesh MeshOf(const TopoDS_Face& face) {
  FaceMesh mesh;
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return mesh;
  const gp_Trsf placement = location.Transformation();
  TopLoc_Location surface_location;
  const GeomAdaptor_Surface surface(Untrimmed(BRep_Tool::Surface(face, surface_location)));
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  std::vector<bool> unsigned_normal;
  for (int i = 1; i <= triangulation->NbNodes(); ++i) {
    mesh.positions.push_back(ToVec3(triangulation->Node(i).Transformed(placement).XYZ()));
    bool sign_unknown = false;
    Vec3 normal;
    if (triangulation->HasUVNodes())
      normal = NormalAt(surface, triangulation->UVNode(i), placement, &sign_unknown);
    if (!IsStorable(mesh.positions.back())) return {};
    if (!IsStorable(normal)) normal = {};
    mesh.normals.push_back(reversed ? -normal : normal);
    unsigned_normal.push_back(sign_unknown);
  }
  for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
    int a, b, c;
    triangulation->Triangle(i).Get(a, b, c);
    if (reversed) std::swap(b, c);
    mesh.triangles.push_back({static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1),
                              static_cast<std::uint32_t>(c - 1)});
  }
  FinishNormals(unsigned_normal, mesh);
  return mesh;
}

class GltfWriter {
 public:
  explicit GltfWriter(const Model& model) : model_(model) {
    gltf_.asset.version = "2.0";
    gltf_.asset.generator = "facetless-import";
    gltf_.buffers.resize(1);
    // There is one buffer view for positions and normals, and one for indices.
    gltf_.bufferViews.resize(2);
  }

  // Adds the part's faces in order. `unmeshed` receives the names of those without triangles.
  void AddPart(std::uint32_t index, const std::vector<FaceMesh>& faces, std::vector<std::string>& unmeshed) {
    Box3 box;
    for (const FaceMesh& face : faces) {
      for (const Vec3& p : face.positions) box.Add(p);
    }
    const Vec3 center = box.center();
    centers_.push_back(center);
    tinygltf::Mesh mesh;
    mesh.name = model_.parts[index].name;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (faces[f].triangles.empty()) {
        unmeshed.push_back(FaceName(index, static_cast<std::uint32_t>(f)));
        continue;
      }
      tinygltf::Primitive primitive = AddFace(faces[f], center);
      primitive.extras = tinygltf::Value({{"face", tinygltf::Value(static_cast<int>(f))}});
      mesh.primitives.push_back(std::move(primitive));
    }
    mesh_of_part_.push_back(mesh.primitives.empty() ? -1 : static_cast<int>(gltf_.meshes.size()));
    if (!mesh.primitives.empty()) gltf_.meshes.push_back(std::move(mesh));
  }

  Result<void> Write(const MeshReport& report, const std::string& path) {
    AddNodes();
    tinygltf::Value::Array unmeshed;
    for (const std::string& name : report.faces_unmeshed) unmeshed.emplace_back(name);
    gltf_.asset.extras = tinygltf::Value({{"deflection_mm", tinygltf::Value(report.deflection_mm)},
                                          {"angular_deg", tinygltf::Value(report.angular_deg)},
                                          {"mesh_ms", tinygltf::Value(report.mesh_ms)},
                                          {"faces_unmeshed", tinygltf::Value(unmeshed)},
                                          {"from_model", tinygltf::Value(true)}});
    JoinBuffers();
    const std::string partial = path + ".partial";
    if (!tinygltf::TinyGLTF().WriteGltfSceneToFile(&gltf_, partial, false, true, false, true) ||
        std::rename(partial.c_str(), path.c_str()) != 0) {
      std::remove(partial.c_str());
      return Error{ErrorCode::kWriteFailed, "The mesh " + path + " cannot be written; is the disk full?"};
    }
    return {};
  }

 private:
  std::string FaceName(std::uint32_t part, std::uint32_t face) const {
    for (const Instance& instance : model_.instances) {
      if (instance.part == part) return model_.PlacedFaceName(instance.first_placed_face + face);
    }
    return model_.parts[part].name;
  }

  template <typename T>
  static void AppendBytes(std::vector<unsigned char>& bytes, const T& value) {
    const auto* first = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(T));
  }

  int AddVectors(const std::vector<Vec3>& vectors, Vec3 origin, bool bounded) {
    tinygltf::Accessor accessor;
    accessor.bufferView = 0;
    accessor.byteOffset = vectors_.size();
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.count = vectors.size();
    accessor.type = TINYGLTF_TYPE_VEC3;
    std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (const Vec3& v : vectors) {
      const Vec3 moved = v - origin;
      const std::array<float, 3> stored{static_cast<float>(moved.x), static_cast<float>(moved.y),
                                        static_cast<float>(moved.z)};
      AppendBytes(vectors_, stored);
      for (int k = 0; k < 3; ++k) {
        low[k] = std::fmin(low[k], stored[k]);
        high[k] = std::fmax(high[k], stored[k]);
      }
    }
    if (bounded) {
      accessor.minValues.assign(low.begin(), low.end());
      accessor.maxValues.assign(high.begin(), high.end());
    }
    gltf_.accessors.push_back(std::move(accessor));
    return static_cast<int>(gltf_.accessors.size()) - 1;
  }

  tinygltf::Primitive AddFace(const FaceMesh& face, Vec3 center) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = AddVectors(face.positions, center, true);
    primitive.attributes["NORMAL"] = AddVectors(face.normals, {}, false);
    tinygltf::Accessor indices;
    indices.bufferView = 1;
    indices.byteOffset = indices_.size();
    indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    indices.count = 3 * face.triangles.size();
    indices.type = TINYGLTF_TYPE_SCALAR;
    for (const auto& triangle : face.triangles) AppendBytes(indices_, triangle);
    gltf_.accessors.push_back(std::move(indices));
    primitive.indices = static_cast<int>(gltf_.accessors.size()) - 1;
    return primitive;
  }

  // The root node transforms millimetres, Z up, into metres, Y up: (x, y, z) -> (x, z, -y) / 1000, as a
  // column-major matrix.
  void AddNodes() {
    tinygltf::Node root;
    root.name = model_.info.file;
    root.matrix = {1e-3, 0, 0, 0, 0, 0, -1e-3, 0, 0, 1e-3, 0, 0, 0, 0, 0, 1};
    gltf_.nodes.emplace_back();
    for (const Instance& instance : model_.instances) {
      tinygltf::Node node;
      node.name = instance.name;
      node.mesh = mesh_of_part_[instance.part];
      const auto& m = instance.placement.m;
      const Vec3 origin = instance.placement.Point(centers_[instance.part]);
      node.matrix = {m[0][0], m[1][0], m[2][0], 0, m[0][1],  m[1][1],  m[2][1],  0,
                     m[0][2], m[1][2], m[2][2], 0, origin.x, origin.y, origin.z, 1};
      node.extras = tinygltf::Value(
          {{"first_placed_face", tinygltf::Value(static_cast<double>(instance.first_placed_face))}});
      root.children.push_back(static_cast<int>(gltf_.nodes.size()));
      gltf_.nodes.push_back(std::move(node));
    }
    gltf_.nodes.front() = std::move(root);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    gltf_.scenes.push_back(std::move(scene));
    gltf_.defaultScene = 0;
  }

  void JoinBuffers() {
    gltf_.bufferViews[0].buffer = gltf_.bufferViews[1].buffer = 0;
    gltf_.bufferViews[0].byteLength = vectors_.size();
    gltf_.bufferViews[0].byteStride = 3 * sizeof(float);
    gltf_.bufferViews[0].target = TINYGLTF_TARGET_ARRAY_BUFFER;
    gltf_.bufferViews[1].byteOffset = vectors_.size();
    gltf_.bufferViews[1].byteLength = indices_.size();
    gltf_.bufferViews[1].target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    // Without a triangle, there is no data for the buffer views.
    if (indices_.empty()) {
      gltf_.bufferViews.clear();
      gltf_.buffers.clear();
      return;
    }
    vectors_.insert(vectors_.end(), indices_.begin(), indices_.end());
    gltf_.buffers[0].data = std::move(vectors_);
  }

  const Model& model_;
  tinygltf::Model gltf_;
  std::vector<unsigned char> vectors_, indices_;
  std::vector<Vec3> centers_;
  std::vector<int> mesh_of_part_;
};

double Milliseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

// Meshes the part's faces together, so that neighbouring faces share the nodes of their edges.
void Tessellate(const std::vector<TopoDS_Face>& faces, const MeshOptions& options) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  BRepTools::Clean(compound);
  try {
    OCC_CATCH_SIGNALS
    BRepMesh_IncrementalMesh(compound, options.deflection_mm, false,
                             options.angular_deg * std::numbers::pi / 180, false);
  } catch (const Standard_OutOfMemory&) {
    throw;  // a mesh of only the first faces would suggest that the others have none
  } catch (const Standard_Failure&) {
    // Faces that were meshed before the failure keep their triangles. The rest counts as unmeshed.
  }
}

}  // namespace

Result<MeshReport> WriteMesh(Conversion& conversion, const MeshOptions& options, const std::string& path,
                             const Progress& progress) {
  if (!(options.deflection_mm > 0) || !(options.angular_deg > 0) || !(options.angular_deg <= 180))
    return Error{ErrorCode::kBadUsage,
                 "A mesh needs a deflection above 0 and an angle above 0 and up to 180 degrees."};
  CompleteForOpenCascade(conversion);
  MeshReport report{options.deflection_mm, options.angular_deg, 0, 0, 0, {}};
  MemoryGauge memory;
  GltfWriter writer(conversion.model);
  for (std::uint32_t p = 0; p < conversion.model.parts.size(); ++p) {
    const Range range = conversion.model.parts[p].faces;
    const std::vector<TopoDS_Face> shapes(conversion.faces.begin() + range.first,
                                          conversion.faces.begin() + range.end());
    memory.Begin();
    const auto begin = std::chrono::steady_clock::now();
    Tessellate(shapes, options);
    report.mesh_ms += Milliseconds(std::chrono::steady_clock::now() - begin);
    memory.End();
    std::vector<FaceMesh> meshes;
    for (const TopoDS_Face& shape : shapes) {
      meshes.push_back(MeshOf(shape));
      report.triangles += meshes.back().triangles.size();
    }
    writer.AddPart(p, meshes, report.faces_unmeshed);
    progress(static_cast<double>(p + 1) / static_cast<double>(conversion.model.parts.size()));
  }
  report.peak_bytes = memory.peak_bytes();
  if (Result<void> written = writer.Write(report, path); !written.ok()) return written.error();
  return report;
}

}  // namespace facetless
