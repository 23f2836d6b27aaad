#include "tests/verify/differential/exact_reference.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <ElCLib.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Precision.hxx>
#include <STEPControl_Reader.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gp_Pln.hxx>
#include <unordered_set>
#include <utility>

#include "import/exact_intersector.h"

namespace facetless {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct ReferenceFace {
  TopoDS_Face face;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  Handle(ShapeAnalysis_Surface) surface;  // created when first needed
};

TopoDS_Shape ReadWith(XSControl_Reader& reader, const std::string& path) {
  try {
    OCC_CATCH_SIGNALS
    if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return {};
    reader.TransferRoots();
    return reader.OneShape();
  } catch (const Standard_Failure&) {
    return {};
  }
}

// IGES has an 'S' in column 73 of its first line. STEP begins with its name.
Result<TopoDS_Shape> ReadShape(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{ErrorCode::kFileUnreadable, path + " cannot be read."};
  std::string head(80, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  TopoDS_Shape shape;
  if (head.find("ISO-10303-21") != std::string::npos) {
    STEPControl_Reader reader;
    shape = ReadWith(reader, path);
  } else if (head[72] == 'S') {
    IGESControl_Reader reader;
    shape = ReadWith(reader, path);
  } else {
    return Error{ErrorCode::kFormatUnknown, path + " is neither STEP nor IGES."};
  }
  if (shape.IsNull()) return Error{ErrorCode::kNothingUsable, "OpenCASCADE makes no shape of " + path + "."};
  return shape;
}

gp_Pnt ToPoint(Vec3 p) {
  return {p.x, p.y, p.z};
}
Vec3 ToVec(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

double DistanceToRay(const Ray& ray, Vec3 point) {
  return Length(Cross(point - ray.origin, ray.direction)) / Length(ray.direction);
}

struct NearestOnEdge {
  double distance = kInfinity;
  double parameter = 0;
};

// Returns the point of the edge to which the ray comes closest, at most `window` away in depth from `depth`;
// for points that exceed the window, the excess is added to the distance. The search samples the edge, and
// then uses a golden section around each local minimum.
NearestOnEdge FindNearest(const Ray& ray, const BRepAdaptor_Curve& curve, double depth, double window) {
  constexpr int kSamplesPerInterval = 24;
  const double first = curve.FirstParameter(), last = curve.LastParameter();
  NearestOnEdge best;
  if (Precision::IsInfinite(first) || Precision::IsInfinite(last)) return best;
  const double length = Length(ray.direction);
  const auto offer = [&](double t) {
    const Vec3 point = ToVec(curve.Value(t));
    const double along = Dot(point - ray.origin, ray.direction) / (length * length);
    const double outside = std::max(0.0, std::fabs(along - depth) - window) * length;
    const double distance = std::hypot(DistanceToRay(ray, point), outside);
    if (distance < best.distance) best = {distance, t};
    return distance;
  };
  const int samples = kSamplesPerInterval * std::max(1, curve.NbIntervals(GeomAbs_C1));
  const double step = (last - first) / samples;
  std::vector<double> values;
  for (int i = 0; i <= samples; ++i) values.push_back(offer(first + i * step));
  for (int i = 0; i <= samples; ++i) {
    if ((i > 0 && values[i - 1] < values[i]) || (i < samples && values[i + 1] < values[i])) continue;
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSteps = 60;  // 0.618^60 < 1e-12 of the interval
    double low = first + std::max(0, i - 1) * step, high = first + std::min(samples, i + 1) * step;
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double at_a = offer(a), at_b = offer(b);
    for (int k = 0; k < kSteps; ++k) {
      if (at_a < at_b) {
        high = b;
        b = a;
        at_b = at_a;
        a = high - kGolden * (high - low);
        at_a = offer(a);
      } else {
        low = a;
        a = b;
        at_a = at_b;
        b = low + kGolden * (high - low);
        at_b = offer(b);
      }
    }
  }
  return best;
}

// Returns whether the ray passes the oriented edge on its left, as seen against the normal. The face's
// material is there.
bool PassesInside(const Ray& ray, const BRepAdaptor_Curve& curve, double parameter, bool reversed,
                  Vec3 normal) {
  gp_Pnt at;
  gp_Vec tangent;
  curve.D1(parameter, at, tangent);
  const Vec3 forward = Normalized(ray.direction);
  Vec3 into_face = Cross(normal, Vec3{tangent.X(), tangent.Y(), tangent.Z()});
  if (reversed) into_face = -into_face;
  const Vec3 from_edge = ray.origin - ToVec(at);
  const Vec3 lateral = from_edge - Dot(from_edge, forward) * forward;
  return Dot(lateral, into_face - Dot(into_face, forward) * forward) > 0;
}

// Finds the edge to which the ray comes closest, relative to the edge's tolerance (at least tolerance_mm). If
// the face is flat, a point that appears within the tolerance of an edge lies within tolerance / cosine of it
// along the ray. Twice that is allowed, so that an edge far in front or behind does not count.
void FindNearestEdge(const TopoDS_Face& face, const Ray& ray, double depth, Vec3 normal, double tolerance_mm,
                     Judgement& judgement) {
  double best = kInfinity;
  const double length = Length(ray.direction);
  const auto window = [&](double tolerance) { return 2 * tolerance / (judgement.cosine * length); };
  // The face is oriented like its surface's normal, so that its edges run with the material on their left.
  for (TopExp_Explorer edges(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
    TopLoc_Location location;
    double first, last;
    if (BRep_Tool::Degenerated(edge) || BRep_Tool::Curve(edge, location, first, last).IsNull()) continue;
    const BRepAdaptor_Curve curve(edge);
    const double tolerance = std::max(tolerance_mm, BRep_Tool::Tolerance(edge));
    const NearestOnEdge nearest = FindNearest(ray, curve, depth, window(tolerance));
    if (!(nearest.distance / tolerance < best)) continue;
    best = nearest.distance / tolerance;
    judgement.edge_mm = nearest.distance;
    judgement.edge_tolerance_mm = tolerance;
    judgement.inside_edge =
        PassesInside(ray, curve, nearest.parameter, edge.Orientation() == TopAbs_REVERSED, normal);
  }
  if (best <= 1) return;
  // The tolerance of a vertex may be larger than that of its edges. The side is still that of the nearest
  // edge.
  for (TopExp_Explorer vertices(face, TopAbs_VERTEX); vertices.More(); vertices.Next()) {
    const TopoDS_Vertex vertex = TopoDS::Vertex(vertices.Current());
    const Vec3 point = ToVec(BRep_Tool::Pnt(vertex));
    const double tolerance = std::max(tolerance_mm, BRep_Tool::Tolerance(vertex));
    const double along = Dot(point - ray.origin, ray.direction) / (length * length);
    const double distance = DistanceToRay(ray, point);
    if (std::fabs(along - depth) > window(tolerance) || !(distance / tolerance < best)) continue;
    best = distance / tolerance;
    judgement.edge_mm = distance;
    judgement.edge_tolerance_mm = tolerance;
  }
}

// Moves a parameter of a periodic surface into the face's range.
double IntoRange(double t, double low, double high, bool periodic, double period) {
  if (!periodic || (t >= low && t <= high)) return t;
  return ElCLib::InPeriod(t, low, low + period);
}

}  // namespace

struct ReferenceSolid {
  Bnd_Box box;
  std::unique_ptr<BRepClass3d_SolidClassifier> classifier;
};

struct ExactReference::Data {
  std::vector<ReferenceSolid> solids;
  std::vector<ReferenceFace> faces;
  std::unique_ptr<ExactIntersector> intersector;  // for the same faces

  Judgement JudgeFace(int index, const Ray& ray, double depth, double tolerance_mm);
};

ExactReference::ExactReference(std::unique_ptr<Data> data) : data_(std::move(data)) {}
ExactReference::~ExactReference() = default;
ExactReference::ExactReference(ExactReference&&) noexcept = default;
ExactReference& ExactReference::operator=(ExactReference&&) noexcept = default;

Result<ExactReference> ExactReference::Load(const std::string& path, bool one_placement) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  const Result<TopoDS_Shape> shape = ReadShape(path);
  if (!shape.ok()) return shape.error();
  auto data = std::make_unique<Data>();
  std::unordered_set<const void*> known;
  for (TopExp_Explorer faces(shape.value(), TopAbs_FACE); faces.More(); faces.Next()) {
    if (one_placement && !known.insert(faces.Current().TShape().get()).second) continue;
    ReferenceFace face;
    face.face = TopoDS::Face(faces.Current());
    BRepTools::UVBounds(face.face, face.u_low, face.u_high, face.v_low, face.v_high);
    data->faces.push_back(std::move(face));
  }
  for (TopExp_Explorer solids(shape.value(), TopAbs_SOLID); solids.More(); solids.Next()) {
    ReferenceSolid& solid = data->solids.emplace_back();
    BRepBndLib::Add(solids.Current(), solid.box);
    solid.classifier = std::make_unique<BRepClass3d_SolidClassifier>(solids.Current());
  }
  std::vector<TopoDS_Face> shapes;
  for (const ReferenceFace& face : data->faces) shapes.push_back(face.face);
  data->intersector = std::make_unique<ExactIntersector>(shapes);
  if (data->faces.empty()) return Error{ErrorCode::kNothingUsable, path + " has no faces."};
  return ExactReference(std::move(data));
}

std::size_t ExactReference::face_count() const {
  return data_->faces.size();
}

std::string ExactReference::SurfaceName(int face) const {
  switch (BRepAdaptor_Surface(data_->faces[static_cast<std::size_t>(face)].face, false).GetType()) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
      return "Bezier";
    case GeomAbs_BSplineSurface:
      return "B-spline";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_OffsetSurface:
      return "offset";
    default:
      return "other";
  }
}

ReferenceHit ExactReference::Nearest(const Ray& ray, double near) {
  const ExactHit hit = data_->intersector->Nearest(ray.origin, ray.direction, near);
  return {hit.depth, hit.face, hit.failed};
}

Judgement ExactReference::Data::JudgeFace(int index, const Ray& ray, double depth, double tolerance_mm) {
  ReferenceFace& face = faces[static_cast<std::size_t>(index)];
  const Vec3 point = ray.origin + depth * ray.direction;
  Judgement judgement;
  judgement.face = index;
  try {
    OCC_CATCH_SIGNALS
    // Project the point onto the surface.
    if (face.surface.IsNull()) face.surface = new ShapeAnalysis_Surface(BRep_Tool::Surface(face.face));
    const Handle(Geom_Surface) surface = face.surface->Surface();
    gp_Pnt2d foot = face.surface->ValueOfUV(ToPoint(point), Precision::Confusion());
    const gp_Pnt on_surface = face.surface->Value(foot);
    judgement.surface_mm = on_surface.Distance(ToPoint(point));
    foot.SetX(IntoRange(foot.X(), face.u_low, face.u_high, surface->IsUPeriodic(),
                        surface->IsUPeriodic() ? surface->UPeriod() : 0));
    foot.SetY(IntoRange(foot.Y(), face.v_low, face.v_high, surface->IsVPeriodic(),
                        surface->IsVPeriodic() ? surface->VPeriod() : 0));
    gp_Pnt at;
    gp_Vec du, dv;
    surface->D1(foot.X(), foot.Y(), at, du, dv);
    const Vec3 normal = Normalized(Cross(Vec3{du.X(), du.Y(), du.Z()}, Vec3{dv.X(), dv.Y(), dv.Z()}));
    judgement.cosine = std::fabs(Dot(normal, Normalized(ray.direction)));
    // Measure the ray's distance to the edges.
    FindNearestEdge(face.face, ray, depth, normal, tolerance_mm, judgement);
    if (judgement.edge_mm <= judgement.edge_tolerance_mm) {
      judgement.standing = Standing::kEdge;
      return judgement;
    }
    // Classify the foot.
    if (!(judgement.surface_mm <= tolerance_mm)) return judgement;
    const TopAbs_State state = BRepClass_FaceClassifier(face.face, foot, Precision::PConfusion()).State();
    if (state == TopAbs_IN || state == TopAbs_ON) judgement.standing = Standing::kOn;
  } catch (const Standard_Failure&) {
    judgement.standing = Standing::kOff;
  }
  return judgement;
}

Judgement ExactReference::Judge(const Ray& ray, double depth, double tolerance_mm) {
  const Vec3 point = ray.origin + depth * ray.direction;
  Judgement best;
  for (std::size_t i = 0; i < data_->faces.size(); ++i) {
    const Box3& box = data_->intersector->box(static_cast<int>(i));
    if (box.empty() || point.x < box.low.x || point.x > box.high.x || point.y < box.low.y ||
        point.y > box.high.y || point.z < box.low.z || point.z > box.high.z)
      continue;
    const Judgement judgement = data_->JudgeFace(static_cast<int>(i), ray, depth, tolerance_mm);
    if (judgement.standing < best.standing ||
        (judgement.standing == best.standing && judgement.surface_mm < best.surface_mm))
      best = judgement;
  }
  return best;
}

std::size_t ExactReference::solid_count() const {
  return data_->solids.size();
}

std::optional<bool> ExactReference::IsInside(Vec3 point, double tolerance_mm) {
  bool decided = true;
  for (const ReferenceSolid& solid : data_->solids) {
    if (solid.box.IsOut(ToPoint(point))) continue;
    try {
      OCC_CATCH_SIGNALS
      solid.classifier->Perform(ToPoint(point), tolerance_mm);
      if (solid.classifier->State() == TopAbs_IN) return true;
      if (solid.classifier->State() != TopAbs_OUT) decided = false;
    } catch (const Standard_Failure&) {
      decided = false;
    }
  }
  return decided ? std::optional<bool>(false) : std::nullopt;
}

}  // namespace facetless
