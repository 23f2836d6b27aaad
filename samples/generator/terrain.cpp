// A terrain with a lake, trees and houses. The houses are hollow: they have doors, windows and gable roofs.
#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "samples/generator/voxels.h"

namespace facetless::samples {

std::uint32_t PlaceHash(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b9u + 0x85ebca6bu;
  for (const int n : {x, y, z}) {
    h = (h ^ static_cast<std::uint32_t>(n)) * 0xcc9e2d51u;
    h = (h << 15 | h >> 17) * 0x1b873593u;
  }
  h = (h ^ h >> 16) * 0x85ebca6bu;
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  return h ^ h >> 16;
}

namespace {

constexpr int kSide = 192, kHeight = 256;  // of .vxl files; z runs downwards
constexpr int kGround = 235, kLake = 242;  // heights of the plain and of the water

using Color = std::uint32_t;  // 0: air; else blue lowest, and the brightness 128 highest, as Voxlap has it

Color ColorOf(int red, int green, int blue) {
  const auto byte = [](int n) { return static_cast<std::uint32_t>(std::clamp(n, 0, 255)); };
  return 0x80000000u | byte(red) << 16 | byte(green) << 8 | byte(blue);
}

class World {
 public:
  World() : voxels_(static_cast<std::size_t>(kSide) * kSide * kHeight) {}
  Color At(int x, int y, int z) const {
    // Beyond the borders, everything is solid, so that they have no walls.
    return IsIn(x, y, z) ? voxels_[Index(x, y, z)] : ColorOf(0, 0, 0);
  }
  void Set(int x, int y, int z, Color color) {
    if (IsIn(x, y, z)) voxels_[Index(x, y, z)] = color;
  }
  // From the low corner up to, without, the high one.
  void Fill(std::array<int, 3> low, std::array<int, 3> high, Color color) {
    for (int x = low[0]; x < high[0]; ++x)
      for (int y = low[1]; y < high[1]; ++y)
        for (int z = low[2]; z < high[2]; ++z) Set(x, y, z, color);
  }

 private:
  static bool IsIn(int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < kSide && y < kSide && z < kHeight;
  }
  static std::size_t Index(int x, int y, int z) {
    return (static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)) * kHeight +
           static_cast<std::size_t>(z);
  }
  std::vector<Color> voxels_;
};

// Noise of a lattice, 0 … 1, smooth between its points.
double Noise(double x, double y, std::uint32_t seed) {
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double u = smooth(x - i), v = smooth(y - j);
  const auto at = [&](int dx, int dy) { return PlaceHash(i + dx, j + dy, 0, seed) / 4294967296.0; };
  return (at(0, 0) * (1 - u) + at(1, 0) * u) * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v;
}

// The height of the ground, in voxels above the plain.
int Hill(int x, int y) {
  double sum = 0, share = 1;
  for (int octave = 0; octave < 4; ++octave, share *= 0.45) {
    const double scale = (1 << octave) / 56.0;
    sum += share * (Noise(x * scale, y * scale, 11 + static_cast<std::uint32_t>(octave)) - 0.5);
  }
  // The hills rise towards two borders.
  const double rise = std::max(0.0, (x + y - 150.0) / 234.0);
  return static_cast<int>(100 + 34 * sum + 70 * rise * rise) - 100;
}

void MakeGround(World* world) {
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y) {
      const int top = std::min(kGround - Hill(x, y), kHeight - 2);
      const int shade = static_cast<int>(PlaceHash(x / 2, y / 2, 0, 5) % 3) * 6;
      for (int z = std::min(top, kLake); z < kHeight; ++z) {
        Color color = ColorOf(110, 100 + shade, 90);  // rock
        if (top > kLake) {
          color = z < top ? ColorOf(60, 110 + shade, 190) : ColorOf(200, 190, 150);
        } else if (z < top + 2) {
          color = top > kLake - 2      ? ColorOf(215, 200 + shade, 150)
                  : top > kGround - 38 ? ColorOf(80 + shade, 140, 60)
                                       : ColorOf(150 + shade, 145 + shade, 140 + shade);
        }
        world->Set(x, y, z, color);
      }
    }
}

void PlantTree(World* world, int x, int y, int ground, std::uint32_t kind) {
  const int trunk = 4 + static_cast<int>(kind % 3), radius = 3 + static_cast<int>(kind / 3 % 2);
  world->Fill({x, y, ground - trunk}, {x + 1, y + 1, ground}, ColorOf(96, 66, 40));
  const int middle = ground - trunk - radius + 1;
  for (int dx = -radius; dx <= radius; ++dx)
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dz = -radius; dz <= radius; ++dz) {
        const int gap = static_cast<int>(PlaceHash(x + dx, y + dy, middle + dz, 3) % 4);
        if (dx * dx + dy * dy + dz * dz > radius * radius + 1 - gap) continue;
        world->Set(x + dx, y + dy, middle + dz, ColorOf(40 + 8 * gap, 96 + 10 * gap, 44));
      }
}

void BuildHouse(World* world, int x, int y, int length, int width, int ground, std::uint32_t kind) {
  const int height = 8 + static_cast<int>(kind % 2) * 6;
  const Color wall = kind % 3 == 0   ? ColorOf(205, 190, 165)
                     : kind % 3 == 1 ? ColorOf(190, 120, 95)
                                     : ColorOf(225, 225, 215),
              roof = kind % 2 == 0 ? ColorOf(150, 60, 45) : ColorOf(85, 90, 105);
  const int top = ground - height;
  world->Fill({x, y, top}, {x + length, y + width, kGround + 12}, wall);
  world->Fill({x + 1, y + 1, top}, {x + length - 1, y + width - 1, ground}, 0);
  // Windows along the long walls, and a door.
  for (int at = x + 3; at + 2 < x + length; at += 5)
    for (int floor = top + 2; floor + 3 <= ground; floor += 6) {
      world->Fill({at, y, floor}, {at + 2, y + 1, floor + 3}, 0);
      world->Fill({at, y + width - 1, floor}, {at + 2, y + width, floor + 3}, 0);
    }
  world->Fill({x, y + width / 2 - 1, ground - 5}, {x + 1, y + width / 2 + 1, ground}, 0);
  // The roof rises by a voxel with each row, and projects by one; there is no room under it.
  for (int row = -1; row <= width / 2; ++row) {
    const int z = top - 1 - row;
    world->Fill({x - 1, y + row, z}, {x + length + 1, y + row + 1, z + 1}, roof);
    world->Fill({x - 1, y + width - 1 - row, z}, {x + length + 1, y + width - row, z + 1}, roof);
    if (row < 0) continue;
    world->Fill({x, y + row + 1, z}, {x + length, std::max(y + row + 1, y + width - 1 - row), z + 1}, wall);
  }
}

void Build(World* world) {
  struct House {
    int x, y, length, width;
  };
  constexpr House kHouses[] = {{20, 24, 22, 12}, {24, 50, 18, 12}, {52, 22, 18, 14}, {56, 52, 24, 14},
                               {88, 26, 16, 10}, {20, 78, 20, 12}, {54, 84, 16, 12}, {90, 58, 20, 12}};
  std::uint32_t kind = 0;
  for (const House& house : kHouses) {
    int ground = kHeight;
    for (int x = house.x; x < house.x + house.length; ++x)
      for (int y = house.y; y < house.y + house.width; ++y)
        ground = std::min(ground, std::min(kGround - Hill(x, y), kLake));
    BuildHouse(world, house.x, house.y, house.length, house.width, ground, kind++);
  }
  // Trees on a jittered lattice, not in the water and not among the houses.
  for (int i = 0; i < kSide / 13; ++i)
    for (int j = 0; j < kSide / 13; ++j) {
      const std::uint32_t place = PlaceHash(i, j, 0, 9);
      const int x = 13 * i + 3 + static_cast<int>(place % 8),
                y = 13 * j + 3 + static_cast<int>(place / 8 % 8);
      const int ground = kGround - Hill(x, y);
      if (ground > kLake - 2 || ground < kGround - 44 || (x > 14 && x < 116 && y > 18 && y < 100)) continue;
      PlantTree(world, x, y, ground, place / 64 % 6);
    }
}

bool IsVisible(const World& world, int x, int y, int z) {
  return world.At(x - 1, y, z) == 0 || world.At(x + 1, y, z) == 0 || world.At(x, y - 1, z) == 0 ||
         world.At(x, y + 1, z) == 0 || world.At(x, y, z - 1) == 0 || world.At(x, y, z + 1) == 0;
}

// Appends the spans of a column: for each solid interval, the voxels down to the last visible one as its floor, or, if the
// visible ones at its lower end follow hidden ones, those as its ceiling.
void AppendColumn(const World& world, int x, int y, std::string* bytes) {
  const auto append = [&](Color color) {
    for (int shift = 0; shift < 32; shift += 8) bytes->push_back(static_cast<char>(color >> shift & 255));
  };
  int z = 0;
  for (;;) {
    const int air = z;
    while (world.At(x, y, z) == 0) ++z;  // the bottom is solid
    const int begin = z;
    while (z < kHeight && world.At(x, y, z) != 0) ++z;
    const int end = z;
    const bool last = end == kHeight;
    int ceiling = end;
    if (!last)
      while (ceiling > begin && IsVisible(world, x, y, ceiling - 1)) --ceiling;
    int floor_end = ceiling;
    while (floor_end > begin && !IsVisible(world, x, y, floor_end - 1)) --floor_end;
    if (floor_end == begin) floor_end = ceiling = end;
    bytes->push_back(static_cast<char>(last ? 0 : 1 + (floor_end - begin) + (end - ceiling)));
    bytes->push_back(static_cast<char>(begin));
    bytes->push_back(static_cast<char>(floor_end - 1));
    bytes->push_back(static_cast<char>(air));
    for (int at = begin; at < floor_end; ++at) append(world.At(x, y, at));
    for (int at = ceiling; at < end; ++at) append(world.At(x, y, at));
    if (last) return;
  }
}

}  // namespace

nlohmann::ordered_json WriteTerrain(const std::filesystem::path& folder) {
  World world;
  MakeGround(&world);
  Build(&world);
  std::string bytes;
  const auto append = [&](const auto& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  append(std::uint32_t{0x09072000});
  append(std::uint32_t{kSide});
  append(std::uint32_t{kSide});
  for (const double number : {kSide / 2.0, kSide / 2.0, 64.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0})
    append(number);
  std::uint64_t filled = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      AppendColumn(world, x, y, &bytes);
      for (int z = 0; z < kHeight; ++z) filled += world.At(x, y, z) != 0;
    }
  std::ofstream out(folder / "terrain.vxl", std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write terrain.vxl");
  return {{"exit", 0}, {"voxels", {{"size", {kSide, kSide, kHeight}}, {"filled", filled}, {"pitch_mm", 1}}}};
}

}  // namespace facetless::samples
