// The file is a header, then the tree from the root down. The header has the magic bytes, the version, the size, the pitch
// and the origin of the grid, and the length and the checksum of the tree. The tree begins with the kind of the root (0:
// empty, 1: filled, 2: it has children) and its voxel, of 4 bytes each. After a node with children, there are two bytes
// with two bits for the kind of each child, then the voxels of the filled children, and then what follows each child that
// has children, one after the other. There are no offsets, so a file cannot refer to itself.
#include <functional>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

constexpr char kMagic[8] = {'F', 'L', 'V', 'X', 'O', 'C', 'T', '\n'};
constexpr std::uint32_t kVersion = 1;
constexpr unsigned kEmpty = 0, kFilled = 1, kInner = 2;

template <typename T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

unsigned KindOf(const OctreeNode& node) {
  return !node.leaf() ? kInner : node.voxel.filled() ? kFilled : kEmpty;
}

// Appends what follows a node of kInner.
void AppendChildren(const OctreeModel& tree, const OctreeNode& node, std::string& bytes) {
  const OctreeNode* children = tree.Children(node);
  std::uint16_t kinds = 0;
  for (unsigned child = 0; child < 8; ++child)
    kinds = static_cast<std::uint16_t>(kinds | KindOf(children[child]) << (2 * child));
  Append(bytes, kinds);
  for (int child = 0; child < 8; ++child)
    if (KindOf(children[child]) == kFilled) Append(bytes, children[child].voxel.bits);
  for (int child = 0; child < 8; ++child)
    if (!children[child].leaf()) AppendChildren(tree, children[child], bytes);
}

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                   const VoxelFileOptions&) {
  std::unique_ptr<VoxelModel> made;
  const auto* tree = dynamic_cast<const OctreeModel*>(&model);
  if (tree == nullptr) {
    Result<std::unique_ptr<VoxelModel>> converted = Converted(model, "octree");
    if (!converted.ok()) return converted.error();
    made = std::move(converted).value();
    tree = dynamic_cast<const OctreeModel*>(made.get());
  }
  std::string bytes;
  Append(bytes, static_cast<std::uint32_t>(KindOf(tree->root())));
  Append(bytes, tree->root().leaf() ? tree->root().voxel.bits : std::uint32_t{0});
  if (!tree->root().leaf()) AppendChildren(*tree, tree->root(), bytes);
  VoxelFileWriter out(path);
  out.Text(std::string(kMagic, sizeof kMagic));
  out.Number(kVersion);
  const VoxelPoint n = model.size();
  for (const int size : {n.x, n.y, n.z}) out.Number(static_cast<std::uint32_t>(size));
  for (const double number : {grid.pitch, grid.origin.x, grid.origin.y, grid.origin.z}) out.Number(number);
  out.Number(static_cast<std::uint64_t>(bytes.size()));
  out.Number(Checksum({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}));
  out.Text(bytes);
  return out.Finish();
}

// Reads a tree, and fills its leaves into a model.
class TreeReader {
 public:
  TreeReader(VoxelFileReader reader, std::uint64_t max_bytes, OctreeModel* model)
      : reader_(reader), max_bytes_(max_bytes), model_(*model) {}

  // Returns what is wrong; empty if the tree is sound.
  std::string Read() {
    std::uint32_t kind = 0;
    Voxel voxel;
    if (!reader_.Number(&kind) || !reader_.Number(&voxel.bits)) return kShort;
    const VoxelCube root{{0, 0, 0}, model_.level()};
    std::string wrong = kind == kInner ? ReadChildren(root) : ReadLeaf(kind, voxel, root);
    if (wrong.empty() && reader_.left() > 0) wrong = "bytes follow the end of the tree";
    return wrong;
  }
  bool too_large() const { return blocks_ * kBlockBytes > max_bytes_; }

 private:
  static constexpr std::uint64_t kBlockBytes = 8 * sizeof(OctreeNode) + sizeof(std::uint64_t);
  static constexpr const char* kShort = "the tree ends too early";

  std::string ReadLeaf(unsigned kind, Voxel voxel, const VoxelCube& cube) {
    if (kind == kEmpty) return "";
    if (kind != kFilled || voxel.material() == 0)
      return "a node is neither empty nor filled, and has no children";
    if (Intersection(cube.box(), model_.box()).volume() != cube.volume())
      return "a filled node lies outside the model";
    model_.Fill(cube.box(), voxel);
    return "";
  }

  std::string ReadChildren(const VoxelCube& cube) {
    if (cube.level == 0) return "the tree is deeper than its size";
    ++blocks_;
    if (too_large()) return "the tree needs too much memory";
    std::uint16_t kinds = 0;
    if (!reader_.Number(&kinds)) return kShort;
    for (int child = 0; child < 8; ++child) {
      const unsigned kind = kinds >> (2 * child) & 3u;
      Voxel voxel;
      if (kind == kFilled && !reader_.Number(&voxel.bits)) return kShort;
      if (kind == kInner) continue;
      if (std::string wrong = ReadLeaf(kind, voxel, cube.Child(child)); !wrong.empty()) return wrong;
    }
    for (int child = 0; child < 8; ++child)
      if ((kinds >> (2 * child) & 3u) == kInner)
        if (std::string wrong = ReadChildren(cube.Child(child)); !wrong.empty()) return wrong;
    return "";
  }

  VoxelFileReader reader_;
  const std::uint64_t max_bytes_;
  std::uint64_t blocks_ = 0;  // of eight nodes
  OctreeModel& model_;
};

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, options.max_bytes);
  if (!bytes.ok()) return bytes.error();
  VoxelFileReader reader(bytes.value());
  char magic[sizeof kMagic];
  std::uint32_t version = 0, n[3] = {};
  double numbers[4] = {};
  std::uint64_t length = 0, checksum = 0;
  if (!reader.Number(&magic) || std::memcmp(magic, kMagic, sizeof kMagic) != 0)
    return Error{ErrorCode::kFormatUnknown, path + ": is not an octree file of Facetless"};
  bool whole = reader.Number(&version);
  if (whole && version != kVersion)
    return BrokenVoxelFile(path, "the file has version " + std::to_string(version) +
                                     " of the format; version " + std::to_string(kVersion) + " is read");
  for (std::uint32_t& size : n) whole = whole && reader.Number(&size);
  for (double& number : numbers) whole = whole && reader.Number(&number);
  whole = whole && reader.Number(&length) && reader.Number(&checksum);
  if (!whole || length != reader.left())
    return BrokenVoxelFile(path, "the file does not have the length that its header states");
  if (Checksum(reader.rest()) != checksum)
    return BrokenVoxelFile(path, "the checksum does not match the tree");
  const Result<VoxelPoint> size = CheckVoxelSize(path, n[0], n[1], n[2]);
  if (!size.ok()) return size.error();
  auto model = std::make_unique<OctreeModel>(size.value());
  TreeReader tree(reader, options.max_bytes, model.get());
  if (const std::string wrong = tree.Read(); tree.too_large()) {
    return Error{ErrorCode::kLimitExceeded, path + ": the tree needs more than " +
                                                std::to_string(options.max_bytes >> 20) +
                                                " MB; raise --max-view-memory"};
  } else if (!wrong.empty()) {
    return BrokenVoxelFile(path, wrong);
  }
  VoxelFile file{std::move(model), std::nullopt};
  if (numbers[0] > 0 && std::isfinite(numbers[0] + numbers[1] + numbers[2] + numbers[3]))
    file.grid = VoxelGrid{{numbers[1], numbers[2], numbers[3]}, numbers[0], size.value()};
  return file;
}

}  // namespace

VoxelFormat OctFormat() {
  return {".oct", "octree", "", Write, Read};
}

}  // namespace facetless
