// What an inspection picture shows, and with which settings: the value behind --shade.
//
//  1. kStudio is the picture of render/shade; everything else is drawn by render/inspect.
//  2. zebra, isophotes, reflection, draft and back need a normal, faces and unseen a face id: both tracers
//     have them (a foreign mesh names no faces). curvature needs second derivatives and thickness the exact
//     solid: only the direct renderer has them.
//  3. Text is NAME or NAME:KEY=VALUE,KEY=VALUE…; a value may hold commas itself, as a direction does.
//     FormatInspection gives the text with every setting of the kind, and ParseInspection reads it back.
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

// In the model's axes, or in the viewer's: x right, y up, z towards the viewer.
struct InspectionDirection {
  Vec3 vector{0, 0, 1};
  bool of_view = false;
};

struct ValueRange {
  double low = 0, high = 1;
};

struct Inspection {
  InspectionKind kind = InspectionKind::kStudio;
  int count = 24;  // zebra's stripes, isophotes' bands from pole to pole; reflection's lines all round
  InspectionDirection
      direction;  // zebra's axis, isophotes' light, the way of reflection's lines, draft's pull
  CurvatureKind curvature = CurvatureKind::kMean;
  double limit_deg = 3;             // draft: what is enough
  std::optional<ValueRange> range;  // curvature and thickness; none: a robust one of each view
  int few_pixels = 16;              // unseen: a face with fewer pixel centres is hardly seen
  Orient orient = Orient::kFile;    // set by its own option (--orient), not in the text of --shade
};

// "studio", "zebra", …, in the order of InspectionKind.
const std::vector<std::string>& InspectionNames();

// Error: kBadUsage names what is allowed.
Result<Inspection> ParseInspection(const std::string& text);
std::string FormatInspection(const Inspection& inspection);

// Law 2. `names_faces`: of a mesh, Mesh::from_model. Error: kBadUsage says what is missing.
bool NeedsExactSurface(InspectionKind kind);
Result<void> CheckMeshCanShow(const Inspection& inspection, bool names_faces);

// The unit vector in model axes.
Vec3 Resolved(const InspectionDirection& direction, const CameraFrame& frame);

}  // namespace facetless
