#include "render/compare/mesh_deviation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include <nlohmann/json.hpp>

#include "render/base/parallel.h"
#include "render/compare/surface_pieces.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they lie in memory");

// The number of sample points along each border: they serve as starts, and to prove that the surface closes.
constexpr int kPerSpan = 4, kFewest = 6, kMost = 40;
// The number of pieces of the surface from which Newton's method starts for one point: the nearest first,
// after the foot point of the previous point.
constexpr int kMostStarts = 8;
// The first distance from a collapsed border at which a normal is looked for, and the bound below which the
// tangents span no plane.
constexpr double kBackFromPole = 0x1p-16,
                 kSingular = 0x1p-26;  // shares of a parameter's range; of the tangents' squares
// The number of triangles whose foot points are proven, those of the largest deviations first. The lower
// bound is proven to the share kProven of the distance, with at most kMostProofPieces pieces.
constexpr std::size_t kMostProven = 256;
constexpr double kProven = 0x1p-10;
constexpr int kMostProofPieces = 1 << 12;
constexpr int kMostIterations = 24, kMostHalvings = 4;
// On a collapsed border all parameters give the same point, and no step leads away from it. In its first
// iterations Descend therefore goes at most half the way to a border, until the other parameter has settled.
constexpr int kTimidIterations = 8;
// A step of less than this share of the parameters' range moves the foot point by less than its rounding.
constexpr double kSmallestStep = 0x1p-44;
// Points of a surface that differ by less than this, relative to its coordinates, are the same point: files
// store fewer digits.
constexpr double kSamePoint = 1e-9;
// The number of triangles of one task. Each passes its foot points to the next as starts.
constexpr std::size_t kTrianglesPerTask = 1024;

struct Parameters {
  double u = 0, v = 0;
};

// One parameter of the grid: an interval, or a circle if the surface closes there.
class Direction {
 public:
  Direction() = default;
  Direction(double begin, double end) : begin_(begin), end_(end) {}

  void Close() { closed_ = true; }
  double At(double share) const { return begin_ + (end_ - begin_) * share; }
  // Maps `t` into the grid: around a closed parameter, else onto the border. Requires `from` in the grid, and
  // `t` less than one period away from it. If `timid`, a step beyond a border ends halfway between `from` and
  // the border.
  double Within(double from, double t, bool timid) const {
    if (closed_ && t < begin_) t += end_ - begin_;
    if (closed_ && t > end_) t -= end_ - begin_;
    if (timid && t < begin_) return (from + begin_) / 2;
    if (timid && t > end_) return (from + end_) / 2;
    return std::clamp(t, begin_, end_);
  }
  // Returns true if `t` is on a border and descent along the gradient would leave the grid there.
  bool Held(double t, double gradient) const {
    return !closed_ && ((t <= begin_ && gradient > 0) || (t >= end_ && gradient < 0));
  }
  bool OnBorder(double t) const { return t <= begin_ || t >= end_; }
  bool Differ(double s, double t) const { return std::fabs(s - t) > kSmallestStep * (end_ - begin_); }

 private:
  double begin_ = 0, end_ = 1;
  bool closed_ = false;
};

struct Start {
  Parameters at;
  Vec3 point;
};

// One side of the grid: points on it, and the largest distance between neighbours.
struct Border {
  std::vector<Start> starts;
  double spacing = 0;
};

// The surface of one face, with points to start from.
class FaceSurface {
 public:
  FaceSurface(const Model& model, const Face& face)
      : surface_(model, face.surface), pieces_(model, face.surface), sign_(face.reversed ? -1 : 1) {
    const Surface& grid = model.surfaces[face.surface];
    u_ = {surface_.u_begin(), surface_.u_end()};
    v_ = {surface_.v_begin(), surface_.v_end()};
    const int nu = Count(grid.u_spans.count), nv = Count(grid.v_spans.count);
    // Where both ends of a parameter are the same curve, the parameter is closed, and steps may cross the
    // curve.
    const auto meet = [&](Vec3 a, Vec3 b) { return Length(a - b) <= kSamePoint * surface_.magnitude(); };
    bool closed_u = true, closed_v = true;
    for (int j = 0; j < nv; ++j) {
      const double v = v_.At((j + 0.5) / nv);
      closed_u = closed_u && meet(surface_.Position(u_.At(0), v), surface_.Position(u_.At(1), v));
    }
    for (int i = 0; i < nu; ++i) {
      const double u = u_.At((i + 0.5) / nu);
      closed_v = closed_v && meet(surface_.Position(u, v_.At(0)), surface_.Position(u, v_.At(1)));
    }
    if (closed_u) u_.Close();
    if (closed_v) v_.Close();
    for (int side = 0; side < 4; ++side) {
      Border& border = borders_[side];
      const int n = side < 2 ? nv : nu;
      for (int k = 0; k <= n; ++k) {
        const double along = static_cast<double>(k) / n, across = side % 2;
        const Parameters at =
            side < 2 ? Parameters{u_.At(across), v_.At(along)} : Parameters{u_.At(along), v_.At(across)};
        border.starts.push_back({at, surface_.Position(at.u, at.v)});
        if (k > 0)
          border.spacing =
              std::max(border.spacing, Length(border.starts[k].point - border.starts[k - 1].point));
      }
    }
  }

  // Returns the signed distance of `point`. `hint` is a start that may be near; it is set to the foot point.
  double Distance(Vec3 point, Start& hint, int most_starts = kMostStarts) const {
    Foot foot = Descend(point, hint);
    int starts = 0;
    // A box that lies nearer than the foot point may contain a nearer one.
    pieces_.VisitNear(point, foot.squared, [&](const SurfacePieces::Piece& piece, double) {
      const Foot other = Descend(point, {{piece.u, piece.v}, surface_.Position(piece.u, piece.v)});
      if (other.squared < foot.squared) foot = other;
      return ++starts < most_starts ? foot.squared : 0;
    });
    const Foot border = NearestOnBorders(point, foot);
    if (border.squared < foot.squared) foot = border;
    hint = foot.at;
    const Vec3 off = point - foot.surface.position;
    return std::copysign(std::sqrt(foot.squared), sign_ * Dot(off, NormalAt(foot)));
  }
  // Returns a lower bound of the distance. Requires that the distance is at most `found`.
  double LeastDistance(Vec3 point, double found) const {
    return std::min(found, pieces_.LowerBound(point, (1 - kProven) * found, kMostProofPieces));
  }
  Start first() const {
    const Parameters at = {u_.At(0.5), v_.At(0.5)};
    return {at, surface_.Position(at.u, at.v)};
  }

 private:
  static int Count(std::uint32_t spans) {
    return std::clamp(static_cast<int>(std::min(spans, 1000u)) * kPerSpan, kFewest, kMost);
  }
  static double SquaredTo(Vec3 a, Vec3 b) { return Dot(a - b, a - b); }

  struct Foot {
    Start at;
    SurfacePoint surface;
    double squared = 0;
  };

  // On a collapsed border the tangents span no plane; the normal of a point slightly inside is returned
  // there.
  Vec3 NormalAt(const Foot& foot) const {
    Vec3 normal = Cross(foot.surface.du, foot.surface.dv);
    const double longest =
        std::max(Dot(foot.surface.du, foot.surface.du), Dot(foot.surface.dv, foot.surface.dv));
    for (double back = kBackFromPole; back < 1 && !(Length(normal) > kSingular * longest); back *= 4) {
      const SurfacePoint inside = surface_.First(foot.at.at.u + back * (u_.At(0.5) - foot.at.at.u),
                                                 foot.at.at.v + back * (v_.At(0.5) - foot.at.at.v));
      normal = Cross(inside.du, inside.dv);
    }
    return normal;
  }

  // Returns the nearest point of the borders if it is nearer than `best`, else `best`. On a border, which is
  // a curve, Newton's method has one parameter; on a collapsed border it has none.
  Foot NearestOnBorders(Vec3 point, const Foot& best) const {
    Foot nearest = best;
    for (int side = 0; side < 4; ++side) {
      const Border& border = borders_[side];
      const Start* start = &border.starts.front();
      for (const Start& one : border.starts)
        if (SquaredTo(point, one.point) < SquaredTo(point, start->point)) start = &one;
      if (std::sqrt(SquaredTo(point, start->point)) - border.spacing > std::sqrt(nearest.squared)) continue;
      Foot foot = {*start, surface_.Second(start->at.u, start->at.v), SquaredTo(point, start->point)};
      for (int i = 0; i < kMostIterations; ++i) {
        const bool along_v = side < 2;
        const Vec3 off = foot.surface.position - point, d = along_v ? foot.surface.dv : foot.surface.du,
                   dd = along_v ? foot.surface.dvv : foot.surface.duu;
        const double slope = Dot(off, d), square = Dot(d, d), bend = square + Dot(off, dd);
        if (!(square > 0)) break;
        const double step = -slope / (bend > 0 ? bend : square);
        if (!Improve(point, along_v ? Parameters{0, step} : Parameters{step, 0}, false, foot)) break;
      }
      if (foot.squared < nearest.squared) nearest = foot;
    }
    return nearest;
  }

  // Minimizes half the squared distance within the grid. Each iteration takes Newton's step if it leads
  // nearer, else the Gauss–Newton step, which leaves out the second derivatives, else a step along each
  // parameter separately.
  Foot Descend(Vec3 point, const Start& start) const {
    Foot foot = {start, surface_.Second(start.at.u, start.at.v), SquaredTo(point, start.point)};
    for (int i = 0; i < kMostIterations; ++i) {
      const SurfacePoint& at = foot.surface;
      const Vec3 off = at.position - point;
      const double gu = Dot(off, at.du), gv = Dot(off, at.dv);
      const double a = Dot(at.du, at.du), b = Dot(at.du, at.dv), c = Dot(at.dv, at.dv);
      const bool held_u = u_.Held(foot.at.at.u, gu), held_v = v_.Held(foot.at.at.v, gv);
      const auto along = [](double slope, double bend) { return bend > 0 ? -slope / bend : 0; };
      const Parameters apart = {held_u ? 0 : along(gu, a), held_v ? 0 : along(gv, c)};
      const auto solved = [&](double aa, double bb, double cc) -> Parameters {
        const double determinant = aa * cc - bb * bb;
        if (held_u || held_v || !(aa > 0) || !(determinant > 0)) return apart;
        return {(bb * gv - cc * gu) / determinant, (bb * gu - aa * gv) / determinant};
      };
      const bool timid = i < kTimidIterations;
      const bool nearer =
          Improve(point, solved(a + Dot(off, at.duu), b + Dot(off, at.duv), c + Dot(off, at.dvv)), timid,
                  foot) ||
          Improve(point, solved(a, b, c), timid, foot) || Improve(point, apart, timid, foot);
      if (!nearer) break;
    }
    return foot;
  }
  // Takes the step, or a fraction of it, if that leads nearer; returns whether it did.
  bool Improve(Vec3 point, Parameters step, bool timid, Foot& foot) const {
    const Parameters here = foot.at.at;
    for (int halving = 0; halving <= kMostHalvings; ++halving, step = {step.u / 2, step.v / 2}) {
      const Parameters next = {u_.Within(here.u, here.u + step.u, timid),
                               v_.Within(here.v, here.v + step.v, timid)};
      if (!u_.Differ(next.u, here.u) && !v_.Differ(next.v, here.v)) return false;
      const SurfacePoint there = surface_.Second(next.u, next.v);
      const double squared = SquaredTo(point, there.position);
      if (!(squared < foot.squared)) continue;
      foot = {{next, there.position}, there, squared};
      return true;
    }
    return false;
  }

  SurfaceEval surface_;
  SurfacePieces pieces_;
  double sign_;
  Direction u_, v_;
  Border borders_[4];  // u low, u high, v low, v high
};

Vec3 Corner(const MeshPart& part, std::uint32_t vertex) {
  const auto& p = part.positions[vertex];
  return {p[0], p[1], p[2]};
}

// The prototype of a part of the mesh, and the placement that leads to the prototype's coordinates: the
// positions of the mesh are relative to a centre of the part, which is in the node's placement.
struct Prototype {
  Range faces;
  Placement to;
};

Result<Prototype> PrototypeOf(const Model& model, const Mesh& mesh, std::size_t part) {
  for (const MeshNode& node : mesh.nodes) {
    if (node.part != part) continue;
    const Instance* placed = nullptr;
    for (const Instance& instance : model.instances) {
      if (instance.first_placed_face == node.first_placed_face) placed = &instance;
    }
    if (placed == nullptr || placed->part >= model.parts.size()) break;
    // The columns of the inverse of the instance's linear part are cross products of its rows.
    const auto& m = placed->placement.m;
    const Vec3 row[3] = {
        {m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
    const Vec3 column[3] = {Cross(row[1], row[2]), Cross(row[2], row[0]), Cross(row[0], row[1])};
    const double determinant = Dot(row[0], column[0]);
    const auto back = [&](Vec3 v) {
      return (1 / determinant) * (v.x * column[0] + v.y * column[1] + v.z * column[2]);
    };
    const auto& n = node.placement.m;
    Prototype prototype = {model.parts[placed->part].faces, {}};
    for (int c = 0; c < 4; ++c) {
      const Vec3 own = c == 3 ? Vec3{m[0][3], m[1][3], m[2][3]} : Vec3{};
      const Vec3 v = back(Vec3{n[0][c], n[1][c], n[2][c]} - own);
      prototype.to.m[0][c] = v.x;
      prototype.to.m[1][c] = v.y;
      prototype.to.m[2][c] = v.z;
    }
    return prototype;
  }
  return Error{ErrorCode::kInternal, "a part of the mesh belongs to no part of the model"};
}

// Returns the four points of a triangle at which its deviation is measured.
std::array<Vec3, 4> PlacesOf(const MeshPart& part, const Placement& place, std::size_t triangle) {
  const auto& t = part.triangles[triangle];
  const Vec3 a = place.Point(Corner(part, t[0])), b = place.Point(Corner(part, t[1])),
             c = place.Point(Corner(part, t[2]));
  return {(1.0 / 3) * (a + b + c), 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)};
}

float TriangleDeviation(const FaceSurface& surface, const MeshPart& part, const Placement& place,
                        std::size_t triangle, Start& hint, int most_starts = kMostStarts) {
  double largest = 0;
  for (const Vec3 point : PlacesOf(part, place, triangle)) {
    const double distance = surface.Distance(point, hint, most_starts);
    if (!(std::fabs(distance) <= std::fabs(largest))) largest = distance;
  }
  return static_cast<float>(largest);
}

// The range [begin, end) of the triangles of one face.
struct FaceRun {
  std::size_t begin = 0, end = 0;
};

std::vector<FaceRun> FaceRuns(const MeshPart& part) {
  std::vector<FaceRun> runs;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    if (i == 0 || part.face_of_triangle[i] != part.face_of_triangle[i - 1]) runs.push_back({i, i});
    runs.back().end = i + 1;
  }
  return runs;
}

// Measures the triangles of the largest deviations again, from all starts, and proves lower bounds of their
// distances, until a bound is at least as large as the next deviation. Returns false if cancelled.
bool ProveLargest(const Model& model, const Mesh& mesh, const std::vector<Prototype>& prototypes,
                  const Execution& execution, MeshDeviation* deviation) {
  struct Candidate {
    float size;
    std::size_t part, triangle;
  };
  std::vector<Candidate> candidates;
  for (std::size_t p = 0; p < deviation->parts.size(); ++p)
    for (std::size_t i = 0; i < deviation->parts[p].size(); ++i)
      candidates.push_back({std::fabs(deviation->parts[p][i]), p, i});
  const auto order = [](const Candidate& a, const Candidate& b) {
    return std::tuple{-a.size, a.part, a.triangle} < std::tuple{-b.size, b.part, b.triangle};
  };
  const std::size_t most = std::min(kMostProven, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(most),
                    candidates.end(), order);
  std::map<std::uint32_t, std::unique_ptr<FaceSurface>> surfaces;
  for (std::size_t k = 0; k < most && deviation->largest_at_least_mm < candidates[k].size; ++k) {
    if (execution.cancelled()) return false;
    const Candidate& at = candidates[k];
    const MeshPart& part = mesh.parts[at.part];
    const Prototype& prototype = prototypes[at.part];
    const std::uint32_t face = prototype.faces.first + part.face_of_triangle[at.triangle];
    std::unique_ptr<FaceSurface>& surface = surfaces[face];
    if (surface == nullptr) surface = std::make_unique<FaceSurface>(model, model.faces[face]);
    float& value = deviation->parts[at.part][at.triangle];
    double least = 0, largest = 0;
    for (const Vec3 point : PlacesOf(part, prototype.to, at.triangle)) {
      Start hint = surface->first();
      const double distance = surface->Distance(point, hint, std::numeric_limits<int>::max());
      if (!(std::fabs(distance) <= std::fabs(largest))) largest = distance;
      least = std::max(least, surface->LeastDistance(point, std::fabs(distance)));
    }
    if (std::fabs(largest) < std::fabs(value)) value = static_cast<float>(largest);
    deviation->largest_at_least_mm = std::max(deviation->largest_at_least_mm, least);
  }
  return true;
}

void Append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

}  // namespace

Result<MeshDeviation> MeasureMeshDeviation(const Model& model, const Mesh& mesh, const Execution& execution) {
  if (!mesh.from_model)
    return Error{ErrorCode::kBadUsage,
                 "the deviation of triangles is measured on our own tessellation only: a mesh of yours names "
                 "no faces"};
  MeshDeviation deviation;
  deviation.faces_missing = mesh.faces_unmeshed;
  for (const MeshPart& part : mesh.parts) deviation.triangles += part.triangles.size();
  if (deviation.triangles > kMostMeasuredTriangles)
    return Error{ErrorCode::kLimitExceeded,
                 "the mesh has " + std::to_string(deviation.triangles) + " triangles, and the deviation of " +
                     std::to_string(kMostMeasuredTriangles) + " at most is measured; ask for a coarser mesh"};

  std::vector<Prototype> prototypes;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const MeshPart& part = mesh.parts[p];
    std::vector<float> values(part.triangles.size());
    const auto prototype = PrototypeOf(model, mesh, p);
    if (!prototype) return prototype.error();
    prototypes.push_back(prototype.value());
    const Range faces = prototype.value().faces;
    const std::vector<FaceRun> runs = FaceRuns(part);
    RunWithThreads(execution.threads, [&] {
      ParallelFor(std::size_t{0}, runs.size(), [&](std::size_t r) {
        if (execution.cancelled()) return;
        const FaceRun run = runs[r];
        const std::uint32_t face = faces.first + part.face_of_triangle[run.begin];
        const FaceSurface surface(model, model.faces[face]);
        const std::size_t tasks = (run.end - run.begin + kTrianglesPerTask - 1) / kTrianglesPerTask;
        ParallelFor(std::size_t{0}, tasks, [&](std::size_t task) {
          Start hint = surface.first();
          const std::size_t begin = run.begin + task * kTrianglesPerTask;
          for (std::size_t i = begin; i < std::min(begin + kTrianglesPerTask, run.end); ++i) {
            if (execution.cancelled()) return;
            values[i] = TriangleDeviation(surface, part, prototype.value().to, i, hint);
          }
        });
      });
    });
    if (execution.cancelled()) return Error{ErrorCode::kCancelled, "stopped"};
    deviation.parts.push_back(std::move(values));
  }
  if (!ProveLargest(model, mesh, prototypes, execution, &deviation))
    return Error{ErrorCode::kCancelled, "stopped"};

  std::vector<float> sizes;
  sizes.reserve(deviation.triangles);
  for (const std::vector<float>& values : deviation.parts)
    for (const float value : values) sizes.push_back(std::fabs(value));
  if (sizes.empty()) return deviation;
  deviation.largest_mm = *std::max_element(sizes.begin(), sizes.end());
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.99 * static_cast<double>(sizes.size()))) - 1;
  std::nth_element(sizes.begin(), sizes.begin() + rank, sizes.end());
  deviation.p99_mm = sizes[static_cast<std::size_t>(rank)];
  return deviation;
}

std::string EncodeMeshDeviation(const Mesh& mesh, const MeshDeviation& deviation) {
  std::string arrays;
  nlohmann::json header = {{"parts", nlohmann::json::array()}, {"nodes", nlohmann::json::array()}};
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const MeshPart& part = mesh.parts[p];
    nlohmann::json entry = {{"triangles", part.triangles.size()}, {"positions", arrays.size()}};
    for (const auto& triangle : part.triangles) {
      for (const std::uint32_t vertex : triangle) Append(arrays, &part.positions[vertex], 3 * sizeof(float));
    }
    entry["deviations"] = arrays.size();
    Append(arrays, deviation.parts[p].data(), deviation.parts[p].size() * sizeof(float));
    entry["faces"] = arrays.size();
    Append(arrays, part.face_of_triangle.data(), part.face_of_triangle.size() * sizeof(std::uint32_t));
    header["parts"].push_back(std::move(entry));
  }
  for (const MeshNode& node : mesh.nodes) {
    nlohmann::json matrix = nlohmann::json::array();
    for (const auto& row : node.placement.m) {
      for (const double value : row) matrix.push_back(value);
    }
    header["nodes"].push_back(
        {{"part", node.part}, {"matrix", matrix}, {"first_placed_face", node.first_placed_face}});
  }
  std::string text = header.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string bytes;
  bytes.reserve(sizeof length + text.size() + arrays.size());
  Append(bytes, &length, sizeof length);
  return bytes + text + arrays;
}

}  // namespace facetless
