// Inspection: the kind of an inspection picture and its settings. It is the value of --shade.
//
//     Result<Inspection> inspection = ParseInspection("zebra:stripes=24,axis=z");
//     if (!inspection) return inspection.error();
//
//  1. render/shade draws the picture of kStudio; render/inspect draws all other kinds.
//  2. zebra, isophotes, reflection, draft and back need a normal; faces and unseen need a face id. Both
//     tracers provide them, except that a foreign mesh has no face ids. curvature needs second derivatives,
//     and thickness the exact solid, which only the direct renderer provides.
//  3. The text form is NAME or NAME:KEY=VALUE,KEY=VALUE…; a value may itself contain commas, as directions
//     do. FormatInspection returns the text with all settings of the kind, and ParseInspection reads it back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/view/camera.h"

namespace facetless {

enum class InspectionKind : std::uint8_t {
  kStudio,
  kZebra,
  kIsophotes,
  kReflection,
  kCurvature,
  kDraft,
  kThickness,
  kFaces,
  kUnseen,
  kBack,
};

// Which side of a surface counts as its outside, for draft, curvature and thickness.
enum class Orient : std::uint8_t {
  kFile,    // the file's outward side
  kViewer,  // the side that is seen
};

enum class CurvatureKind : std::uint8_t { kGaussian, kMean, kMax, kMin };

// A direction in model axes, or in viewer axes: x right, y up, z towards the viewer.
struct InspectionDirection {
  Vec3 vector{0, 0, 1};
  bool of_view = false;
};

struct ValueRange {
  double low = 0, high = 1;
};

struct Inspection {
  InspectionKind kind = InspectionKind::kStudio;
  int count = 24;  // zebra: stripes; isophotes: bands from pole to pole; reflection: lines around the tunnel
  InspectionDirection
      direction;  // zebra: axis; isophotes: light; reflection: direction of the lines; draft: pull
  CurvatureKind curvature = CurvatureKind::kMean;
  double limit_deg = 3;             // draft: the smallest sufficient angle
  std::optional<ValueRange> range;  // curvature and thickness; nothing: a robust range of each view
  int few_pixels = 16;              // unseen: a face with fewer pixel centres counts as hardly visible
  Orient orient = Orient::kFile;    // set by the option --orient, not by the text of --shade
};

// The names "studio", "zebra", …, in the order of InspectionKind.
const std::vector<std::string>& InspectionNames();

// Reads the text form (law 3). Error: kBadUsage, which lists what is allowed.
Result<Inspection> ParseInspection(const std::string& text);
std::string FormatInspection(const Inspection& inspection);

// Check what a kind needs (law 2). `names_faces` is Mesh::from_model of a mesh. Error: kBadUsage, which
// states what is missing.
bool NeedsExactSurface(InspectionKind kind);
Result<void> CheckMeshCanShow(const Inspection& inspection, bool names_faces);

// The unit vector in model axes.
Vec3 Resolved(const InspectionDirection& direction, const CameraFrame& frame);

}  // namespace facetless
