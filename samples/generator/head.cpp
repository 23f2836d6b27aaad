// A scan of a head: skin, skull, brain with folds and ventricles, air in the mouth, the nose and the throat, and the noise that
// scans have where tissue meets air.
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "samples/generator/voxels.h"

namespace facetless::samples {
namespace {

constexpr int kX = 80, kY = 96, kZ = 88;
constexpr double kPitch = 2.5;  // mm
enum Tissue : std::uint8_t { kAir = 0, kSkin = 60, kSkull = 220, kBrain = 120 };

struct Point {
  double x, y, z;
};

// The squared distance from the centre of an ellipsoid, in its own radii.
double Ellipsoid(Point p, Point center, Point radii) {
  const double x = (p.x - center.x) / radii.x, y = (p.y - center.y) / radii.y, z = (p.z - center.z) / radii.z;
  return x * x + y * y + z * z;
}

// Folds: a product of triangle waves along directions that are no axes, −1 … 1.
double Folds(Point p) {
  const auto wave = [](double at) {
    const double in = at - std::floor(at);
    return in < 0.5 ? 4 * in - 1 : 3 - 4 * in;
  };
  return wave(0.11 * p.x + 0.05 * p.z) * wave(0.09 * p.y - 0.06 * p.x) + 0.5 * wave(0.1 * p.z + 0.07 * p.y);
}

// The face looks along −y.
bool IsInside(Point p) {
  const bool cranium = Ellipsoid(p, {40, 50, 56}, {30, 38, 29}) < 1,
             jaw = Ellipsoid(p, {40, 36, 34}, {23, 27, 22}) < 1,
             neck = p.z < 34 && Ellipsoid({p.x, p.y, 0}, {40, 54, 0}, {17, 19, 1}) < 1,
             nose = Ellipsoid(p, {40, 11, 44}, {5, 8, 8}) < 1,
             chin = Ellipsoid(p, {40, 14, 21}, {9, 8, 7}) < 1,
             ears = Ellipsoid(p, {10, 52, 46}, {4, 7, 9}) < 1 || Ellipsoid(p, {70, 52, 46}, {4, 7, 9}) < 1;
  const bool eyes = Ellipsoid(p, {29, 14, 52}, {6, 4, 4}) < 1 || Ellipsoid(p, {51, 14, 52}, {6, 4, 4}) < 1;
  const bool lips = Ellipsoid(p, {40, 10, 30}, {9, 3, 1.2}) < 1;
  return (cranium || jaw || neck || nose || chin || ears) && !eyes && !lips;
}

Tissue TissueAt(Point p) {
  if (!IsInside(p)) return kAir;
  const double brain = Ellipsoid(p, {40, 50, 58}, {25, 33, 24});
  if (brain < 1) {
    const bool ventricles =
        Ellipsoid(p, {35, 50, 58}, {3, 14, 4}) < 1 || Ellipsoid(p, {45, 50, 58}, {3, 14, 4}) < 1;
    const bool middle = p.x > 39 && p.x < 41 && brain > 0.35 && p.z > 56;
    return ventricles || middle || (brain > 0.6 && Folds(p) > 0.75) ? kAir : kBrain;
  }
  if (Ellipsoid(p, {40, 50, 57}, {28, 36, 27}) < 1) return kSkull;
  const bool mouth = Ellipsoid(p, {40, 24, 30}, {9, 10, 4}) < 1,
             throat = Ellipsoid({p.x, p.y, 0}, {40, 44, 0}, {4, 4, 1}) < 1 && p.z < 38,
             nostrils =
                 Ellipsoid(p, {37, 14, 39}, {1.5, 8, 2}) < 1 || Ellipsoid(p, {43, 14, 39}, {1.5, 8, 2}) < 1;
  if (mouth || throat || nostrils) return kAir;
  const bool spine = p.z < 40 && Ellipsoid({p.x, p.y, 0}, {40, 60, 0}, {6, 6, 1}) < 1;
  return spine ? kSkull : kSkin;
}

}  // namespace

nlohmann::ordered_json WriteHead(const std::filesystem::path& folder) {
  std::vector<char> voxels;
  std::uint64_t filled = 0;
  for (int z = 0; z < kZ; ++z)
    for (int y = 0; y < kY; ++y)
      for (int x = 0; x < kX; ++x) {
        // The noise of a scan moves each sample by up to a third of a voxel.
        const auto moved = [&](int at, std::uint32_t seed) {
          return at + 0.5 + (PlaceHash(x, y, z, seed) % 1024 / 1024.0 - 0.5) * 0.66;
        };
        const Tissue tissue = TissueAt({moved(x, 1), moved(y, 2), moved(z, 3)});
        voxels.push_back(static_cast<char>(tissue));
        filled += tissue != kAir;
      }
  std::ofstream out(folder / "head.nrrd", std::ios::binary);
  out << "NRRD0004\n# A head that was never alive: facetless-samples made it\ntype: uint8\ndimension: 3\n"
         "space dimension: 3\nsizes: "
      << kX << " " << kY << " " << kZ << "\nspace directions: (" << kPitch << ",0,0) (0," << kPitch
      << ",0) (0,0," << kPitch << ")\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: (" << 0.5 * kPitch
      << "," << 0.5 * kPitch << "," << 0.5 * kPitch << ")\nkinds: domain domain domain\nencoding: raw\n\n";
  out.write(voxels.data(), static_cast<std::streamsize>(voxels.size()));
  if (!out.flush()) throw std::runtime_error("cannot write head.nrrd");
  return {{"exit", 0}, {"voxels", {{"size", {kX, kY, kZ}}, {"filled", filled}, {"pitch_mm", kPitch}}}};
}

}  // namespace facetless::samples
