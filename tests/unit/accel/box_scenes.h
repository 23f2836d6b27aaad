// Scenes of boxes, rays and simple objects, on which the structures are compared with a scan.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "render/accel/structure.h"

namespace facetless::testing {

enum class SceneKind {
  kUniform,    // small boxes everywhere
  kClustered,  // in a few places
  kNeedles,    // long and thin, along an axis
  kFlat,       // without thickness, some of them without two
  kIdentical,  // the same box many times
  kTiles,      // cubes of a lattice, which touch each other
  kNested,     // around the same middle
  kFarAway,    // small, at coordinates around 1e7
  kTiny,       // sizes of 1e-6
  kOne,
  kNone,
};
inline constexpr SceneKind kSceneKinds[] = {SceneKind::kUniform, SceneKind::kClustered, SceneKind::kNeedles,
                                            SceneKind::kFlat,    SceneKind::kIdentical, SceneKind::kTiles,
                                            SceneKind::kNested,  SceneKind::kFarAway,   SceneKind::kTiny,
                                            SceneKind::kOne,     SceneKind::kNone};

using Engine = std::mt19937_64;

// In [0, 1).
double Number(Engine& engine);

std::vector<Box3> DrawScene(SceneKind kind, std::size_t most, Engine& engine);

// Rays of all kinds: random, along axes, in faces of boxes, through corners and edges of boxes and of even
// voxels, from inside of boxes, with zero and denormal components, with tiny and huge directions, bounded on
// either side, and from far away.
std::vector<RaySegment> DrawRays(const std::vector<Box3>& boxes, std::size_t count, Engine& engine);

// Whether origin + t·direction meets the box for a t of the interval, in extended precision. The box is made
// larger by `margin` first.
bool MeetsExactly(const RaySegment& ray, const Box3& box, double margin);

enum class ObjectKind { kBox, kSphere };  // the box itself, or the sphere inscribed in its middle

struct ObjectHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t id = UINT32_MAX;

  friend bool operator==(const ObjectHit&, const ObjectHit&) = default;
};

// The parameter at which the ray passes the object's surface first within its interval; infinite if it
// doesn't.
double Intersect(ObjectKind kind, const Box3& box, const RaySegment& ray);

// Takes the object into account. Of equal parameters, the lower id counts.
void AskObject(ObjectKind kind, const std::vector<Box3>& boxes, const RaySegment& ray, std::uint32_t id,
               ObjectHit& nearest);

// The nearest object by a scan of all objects.
ObjectHit NearestByScan(ObjectKind kind, const std::vector<Box3>& boxes, const RaySegment& ray);

}  // namespace facetless::testing
