#include "openvdb/grid_file.h"

#include <cmath>

#include "openvdb/grid_runs.h"
#include "render/image/film.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

constexpr const char *kDensity = "density", *kColor = "Cd", *kMaterial = "material";
constexpr const char *kSize = "facetless_size", *kOrigin = "facetless_origin";

struct Source {
  std::string path;
  double threshold = 0;
  std::uint64_t max_bytes = 0;
  openvdb::Vec3SGrid::Ptr color;
  openvdb::Int32Grid::Ptr material;
};

std::uint8_t ByteOf(float linear) {
  return linear >= 0 ? EncodeByte(linear) : 0;
}

// The size and the low corner of the voxels, from the metadata or from the box of the voxels.
Result<std::pair<openvdb::Coord, VoxelPoint>> PlaceOf(const openvdb::GridBase& grid,
                                                      const openvdb::CoordBBox& box,
                                                      const std::string& path) {
  openvdb::Coord low = box.min();
  std::array<std::int64_t, 3> n = {};
  for (int axis = 0; axis < 3; ++axis)
    n[static_cast<std::size_t>(axis)] = std::int64_t{box.max()[axis]} - box.min()[axis] + 1;
  if (const auto size = grid.getMetadata<openvdb::Vec3IMetadata>(kSize)) {
    const openvdb::Vec3i stated = size->value();
    const openvdb::CoordBBox whole(openvdb::Coord(0), openvdb::Coord(stated) - openvdb::Coord(1));
    if (whole.isInside(box)) {
      low = openvdb::Coord(0);
      n = {stated.x(), stated.y(), stated.z()};
    }
  }
  for (const std::int64_t size : n)
    if (size < 1 || size > kMostVoxelsPerAxis)
      return Error{ErrorCode::kLimitExceeded, path + ": the grid '" + grid.getName() + "' has " +
                                                  std::to_string(size) +
                                                  " voxels along an axis; 65536 are possible"};
  return std::pair{low, VoxelPoint{static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2])}};
}

// Sets the grid in millimetres, or says why there is none.
void SetGrid(const openvdb::GridBase& grid, const openvdb::Coord& low, VoxelPoint size, VoxelFile& file) {
  const openvdb::math::Transform& transform = grid.transform();
  double pitch = 0;
  bool cubes = transform.isLinear();
  if (cubes) {
    // Points are rows, so the first three rows are the steps along the axes.
    const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
    pitch = matrix[0][0];
    constexpr double kRounding = 1e-12;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        cubes = cubes && std::abs(matrix[i][j] - (i == j ? pitch : 0)) <= kRounding * pitch;
  }
  if (!cubes || !(pitch > 0)) {
    file.warnings.push_back(
        "the transform of the grid '" + grid.getName() +
        "' does not make its voxels cubes along the axes, so they are read as if they were");
    return;
  }
  const openvdb::Vec3d center = transform.indexToWorld(low.asVec3d());
  constexpr double kSame = 1e-9;
  Vec3 origin{center.x() - 0.5 * pitch, center.y() - 0.5 * pitch, center.z() - 0.5 * pitch};
  if (const auto stated = grid.getMetadata<openvdb::Vec3DMetadata>(kOrigin);
      stated && low == openvdb::Coord(0))
    if (const Vec3 exact{stated->value().x(), stated->value().y(), stated->value().z()};
        Length(exact - origin) <= kSame * (Length(origin) + pitch))
      origin = exact;
  if (std::isfinite(pitch + origin.x + origin.y + origin.z)) file.grid = VoxelGrid{origin, pitch, size};
}

// Reads one grid. inside(value, active) decides.
template <typename Grid, typename Inside>
Result<VoxelFile> ReadGrid(const Grid& grid, const Source& source, const Inside& inside) {
  openvdb::CoordBBox box;
  VisitInside(grid.tree(), inside, [&](const openvdb::CoordBBox& part) {
    box.expand(part);
    return true;
  });
  if (box.empty())
    return Error{ErrorCode::kNothingUsable,
                 source.path + ": no voxel of the grid '" + grid.getName() +
                     "' is filled; --threshold says above which number voxels are"};
  const auto place = PlaceOf(grid, box, source.path);
  if (!place.ok()) return place.error();
  const auto& [low, size] = place.value();
  const auto too_large = [&] {
    return Error{ErrorCode::kLimitExceeded, source.path + ": the voxels need more than " +
                                                std::to_string(source.max_bytes >> 20) +
                                                " MB; raise --max-view-memory"};
  };
  constexpr double kColumnBytes = 40;
  if (kColumnBytes * size.x * size.y > static_cast<double>(source.max_bytes)) return too_large();
  RunsOfGrid runs(low, size, source.max_bytes);
  if (!VisitInside(grid.tree(), inside, [&](const openvdb::CoordBBox& part) { return runs.Add(part); }))
    return too_large();
  std::optional<openvdb::Vec3SGrid::ConstAccessor> color;
  std::optional<openvdb::Int32Grid::ConstAccessor> material;
  if (source.color) color.emplace(source.color->getConstAccessor());
  if (source.material) material.emplace(source.material->getConstAccessor());
  RunModel model = runs.Take([&](int x, int y, int z) {
    constexpr std::uint8_t kGrey = 178;
    const openvdb::Coord at(x, y, z);
    const int number = material ? material->getValue(at) : 1;
    const auto kept = static_cast<std::uint8_t>(number >= 1 && number <= 255 ? number : 1);
    if (!color) return Voxel::Of(kGrey, kGrey, kGrey, kept);
    const openvdb::Vec3s rgb = color->getValue(at);
    return Voxel::Of(ByteOf(rgb.x()), ByteOf(rgb.y()), ByteOf(rgb.z()), kept);
  });
  VoxelFile file{std::make_unique<RunModel>(std::move(model)), std::nullopt};
  SetGrid(grid, low, size, file);
  return file;
}

template <typename Grid>
std::optional<Result<VoxelFile>> TryNumbers(const openvdb::GridBase& base, const Source& source) {
  if (!base.isType<Grid>()) return std::nullopt;
  const auto& grid = static_cast<const Grid&>(base);
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
    return ReadGrid(grid, source, [](auto value, bool) { return value < 0; });
  const double threshold = source.threshold;
  return ReadGrid(grid, source, [threshold](auto value, bool active) {
    return active && static_cast<double>(value) > threshold;
  });
}

std::optional<Result<VoxelFile>> TryGrid(const openvdb::GridBase& base, const Source& source) {
  if (auto read = TryNumbers<openvdb::FloatGrid>(base, source)) return read;
  if (auto read = TryNumbers<openvdb::DoubleGrid>(base, source)) return read;
  if (auto read = TryNumbers<openvdb::Int32Grid>(base, source)) return read;
  if (auto read = TryNumbers<openvdb::Int64Grid>(base, source)) return read;
  if (base.isType<openvdb::BoolGrid>())
    return ReadGrid(static_cast<const openvdb::BoolGrid&>(base), source,
                    [](bool value, bool active) { return active && value; });
  if (base.isType<openvdb::MaskGrid>())
    return ReadGrid(static_cast<const openvdb::MaskGrid&>(base), source,
                    [](bool, bool active) { return active; });
  return std::nullopt;
}

// Fills the leaves of a tree into the grids.
class GridFiller {
 public:
  explicit GridFiller(const OctreeModel& model)
      : model_(model),
        density_(openvdb::FloatGrid::create(0)),
        color_(openvdb::Vec3SGrid::create(openvdb::Vec3s(0))),
        material_(openvdb::Int32Grid::create(0)),
        densities_(density_->getAccessor()),
        colors_(color_->getAccessor()),
        materials_(material_->getAccessor()) {
    for (int byte = 0; byte < 256; ++byte)
      linear_[static_cast<std::size_t>(byte)] = static_cast<float>(SrgbToLinear(byte / 255.0));
    Fill(model.root(), {{0, 0, 0}, model.level()});
  }
  openvdb::GridPtrVec Grids(const VoxelGrid& grid) {
    density_->setName(kDensity);
    density_->setGridClass(openvdb::GRID_FOG_VOLUME);
    color_->setName(kColor);
    color_->setVectorType(openvdb::VEC_INVARIANT);
    material_->setName(kMaterial);
    const auto transform = openvdb::math::Transform::createLinearTransform(grid.pitch);
    const Vec3 center = grid.Center({0, 0, 0});
    transform->postTranslate(openvdb::Vec3d(center.x, center.y, center.z));
    openvdb::GridPtrVec grids = {density_, color_, material_};
    const VoxelPoint n = model_.size();
    for (const openvdb::GridBase::Ptr& each : grids) {
      each->setTransform(transform);
      each->insertMeta(kSize, openvdb::Vec3IMetadata(openvdb::Vec3i(n.x, n.y, n.z)));
      each->insertMeta(kOrigin,
                       openvdb::Vec3DMetadata(openvdb::Vec3d(grid.origin.x, grid.origin.y, grid.origin.z)));
      each->insertMeta("unit", openvdb::StringMetadata("mm"));
    }
    return grids;
  }

 private:
  void Fill(const OctreeNode& node, const VoxelCube& cube) {
    if (!node.leaf()) {
      for (int child = 0; child < 8; ++child) Fill(model_.Children(node)[child], cube.Child(child));
      return;
    }
    if (!node.voxel.filled()) return;
    const Voxel voxel = node.voxel;
    const openvdb::Vec3s rgb(linear_[voxel.red()], linear_[voxel.green()], linear_[voxel.blue()]);
    const openvdb::Coord low(cube.low.x, cube.low.y, cube.low.z);
    constexpr int kLeafLevel = 3;
    if (cube.level < kLeafLevel) {
      for (int x = 0; x < cube.edge(); ++x)
        for (int y = 0; y < cube.edge(); ++y)
          for (int z = 0; z < cube.edge(); ++z) {
            const openvdb::Coord at = low.offsetBy(x, y, z);
            densities_.setValue(at, 1);
            colors_.setValue(at, rgb);
            materials_.setValue(at, voxel.material());
          }
      return;
    }
    const openvdb::CoordBBox box =
        openvdb::CoordBBox::createCube(low, static_cast<openvdb::Coord::ValueType>(cube.edge()));
    density_->tree().fill(box, 1);
    color_->tree().fill(box, rgb);
    material_->tree().fill(box, voxel.material());
  }

  const OctreeModel& model_;
  std::array<float, 256> linear_ = {};
  openvdb::FloatGrid::Ptr density_;
  openvdb::Vec3SGrid::Ptr color_;
  openvdb::Int32Grid::Ptr material_;
  openvdb::FloatGrid::Accessor densities_;
  openvdb::Vec3SGrid::Accessor colors_;
  openvdb::Int32Grid::Accessor materials_;
};

}  // namespace

Result<VoxelFile> ReadGrids(const std::string& path, double threshold, std::uint64_t max_bytes) {
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  Source source{path, threshold, max_bytes, nullptr, nullptr};
  std::vector<std::string> names;
  std::string refused;
  const openvdb::GridPtrVecPtr grids = file.readAllGridMetadata();
  for (const openvdb::GridBase::Ptr& each : *grids) {
    const std::string name = each->getName();
    if (name == kColor && each->isType<openvdb::Vec3SGrid>()) {
      source.color = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid(name));
      continue;
    }
    names.insert(name == kDensity ? names.begin() : names.end(), name);
    refused += (refused.empty() ? "" : ", ") + name + " of type " + each->valueType();
  }
  const bool ours = !names.empty() && names[0] == kDensity;
  if (ours && file.hasGrid(kMaterial))
    source.material = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid(kMaterial));
  for (const std::string& name : names) {
    const openvdb::GridBase::Ptr metadata = file.readGridMetadata(name);
    const std::string type = metadata->valueType();
    if (type != "float" && type != "double" && type != "int32" && type != "int64" && type != "bool" &&
        type != "mask")
      continue;
    const openvdb::GridBase::Ptr grid = file.readGrid(name);
    if (auto read = TryGrid(*grid, source)) {
      if (read->ok() && names.size() > (source.material ? 2u : 1u))
        read->value().warnings.push_back("the file has several grids; '" + name + "' is read");
      return std::move(*read);
    }
  }
  return Error{ErrorCode::kNothingUsable, path +
                                              ": has no grid of float, double, int32, int64, bool or mask" +
                                              (refused.empty() ? std::string() : "; it has " + refused)};
}

Result<void> WriteGrids(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) {
  // OpenVDB takes the determinant of such a transform for 0.
  constexpr double kSmallest = 2e-5;
  if (!(grid.pitch >= kSmallest))
    return Error{ErrorCode::kBadUsage,
                 "OpenVDB holds no voxels with a side below 2e-5 mm; use another format"};
  std::optional<OctreeModel> copy;
  const auto* tree = dynamic_cast<const OctreeModel*>(&model);
  if (tree == nullptr) tree = &copy.emplace(RunsOf(model));
  GridFiller filler(*tree);
  openvdb::io::File file(path);
  // Blosc is what the other programs use, too.
  file.setCompression(openvdb::io::COMPRESS_ACTIVE_MASK | openvdb::io::COMPRESS_BLOSC);
  openvdb::MetaMap metadata;
  metadata.insertMeta("creator", openvdb::StringMetadata("Facetless"));
  file.write(filler.Grids(grid), metadata);
  file.close();
  return {};
}

}  // namespace facetless
