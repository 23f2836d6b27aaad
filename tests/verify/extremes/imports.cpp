#include "tests/verify/extremes/imports.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "render/model/model_file.h"
#include "server/importer/import_process.h"
#include "tests/unit/server/support.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {
namespace {

struct KnotVector {
  std::vector<int> multiplicities;
  std::vector<double> knots;
};

struct Net {
  int degree_u = 3, degree_v = 3;
  KnotVector u{{4, 4}, {0, 1}}, v{{4, 4}, {0, 1}};
  double size = 10;
  std::function<double(int, int)> weight = {};  // empty: the surface is polynomial
  std::string unit = "SI_UNIT(.MILLI.,.METRE.)";
  std::string corner = {};  // coordinates of the first control point that replace its own
};

int CountOf(const KnotVector& vector, int degree) {
  int sum = 0;
  for (const int multiplicity : vector.multiplicities) sum += multiplicity;
  return sum - degree - 1;
}

std::string Number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17E", x);
  return text;
}

template <typename Items, typename Write>
std::string List(const Items& items, const Write& write) {
  std::string text = "(";
  for (std::size_t i = 0; i < items.size(); ++i) text += (i > 0 ? "," : "") + write(items[i]);
  return text + ")";
}

std::string Reference(int id) {
  return "#" + std::to_string(id);
}

// Writes the lines of a DATA section.
class Writer {
 public:
  int Add(const std::string& entity) {
    text_ += Reference(++last_) + "=" + entity + ";\n";
    return last_;
  }
  int Point(const std::string& coordinates) { return Add("CARTESIAN_POINT('',(" + coordinates + "))"); }
  int Vertex(int point) { return Add("VERTEX_POINT(''," + Reference(point) + ")"); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int last_ = 0;
};

std::string Knots(const KnotVector& vector) {
  return List(vector.multiplicities, [](int m) { return std::to_string(m); });
}
std::string Values(const KnotVector& vector) {
  return List(vector.knots, Number);
}

std::string StepOf(const Net& net) {
  Writer writer;
  const int rows = CountOf(net.u, net.degree_u), columns = CountOf(net.v, net.degree_v);
  std::vector<std::vector<int>> points(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double height = 0.2 * net.size * std::sin(2.4 * i + 1) * std::cos(1.7 * j);
      std::string coordinates = Number(net.size * i / (rows - 1)) + "," +
                                Number(net.size * j / (columns - 1)) + "," + Number(height);
      if (i + j == 0 && !net.corner.empty()) coordinates = net.corner;
      points[i].push_back(writer.Point(coordinates));
    }
  }
  const std::string grid = List(points, [](const std::vector<int>& row) { return List(row, Reference); });
  const std::string knots =
      Knots(net.u) + "," + Knots(net.v) + "," + Values(net.u) + "," + Values(net.v) + ",.UNSPECIFIED.";
  const std::string degrees = std::to_string(net.degree_u) + "," + std::to_string(net.degree_v);
  int surface = 0;
  if (net.weight) {
    std::vector<std::vector<double>> weights(points.size());
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) weights[i].push_back(net.weight(i, j));
    surface = writer.Add("(BOUNDED_SURFACE()B_SPLINE_SURFACE(" + degrees + "," + grid +
                         ",.UNSPECIFIED.,.F.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS(" + knots +
                         ")GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(" +
                         List(weights, [](const std::vector<double>& row) { return List(row, Number); }) +
                         ")REPRESENTATION_ITEM('')SURFACE())");
  } else {
    surface = writer.Add("B_SPLINE_SURFACE_WITH_KNOTS(''," + degrees + "," + grid +
                         ",.UNSPECIFIED.,.F.,.F.,.F.," + knots + ")");
  }
  // The border is polynomial, because its weights are 1.
  const int corners[4] = {writer.Vertex(points[0][0]), writer.Vertex(points[rows - 1][0]),
                          writer.Vertex(points[rows - 1][columns - 1]),
                          writer.Vertex(points[0][columns - 1])};
  const auto edge = [&](int from, int to, int degree, const KnotVector& vector,
                        const std::vector<int>& along) {
    const int curve =
        writer.Add("B_SPLINE_CURVE_WITH_KNOTS(''," + std::to_string(degree) + "," + List(along, Reference) +
                   ",.UNSPECIFIED.,.F.,.F.," + Knots(vector) + "," + Values(vector) + ",.UNSPECIFIED.)");
    return writer.Add("EDGE_CURVE(''," + Reference(corners[from]) + "," + Reference(corners[to]) + "," +
                      Reference(curve) + ",.T.)");
  };
  std::vector<int> first_column, last_column;
  for (int i = 0; i < rows; ++i) {
    first_column.push_back(points[i][0]);
    last_column.push_back(points[i][columns - 1]);
  }
  const int edges[4] = {
      edge(0, 1, net.degree_u, net.u, first_column), edge(1, 2, net.degree_v, net.v, points[rows - 1]),
      edge(3, 2, net.degree_u, net.u, last_column), edge(0, 3, net.degree_v, net.v, points[0])};
  std::vector<int> uses(4);
  for (int k = 0; k < 4; ++k)
    uses[k] = writer.Add("ORIENTED_EDGE('',*,*," + Reference(edges[k]) + (k < 2 ? ",.T.)" : ",.F.)"));
  const int loop = writer.Add("EDGE_LOOP(''," + List(uses, Reference) + ")");
  const int bound = writer.Add("FACE_OUTER_BOUND(''," + Reference(loop) + ",.T.)");
  const int face = writer.Add("ADVANCED_FACE('',(" + Reference(bound) + ")," + Reference(surface) + ",.T.)");
  const int shell = writer.Add("OPEN_SHELL('',(" + Reference(face) + "))");
  const int model = writer.Add("SHELL_BASED_SURFACE_MODEL('',(" + Reference(shell) + "))");
  const int length = writer.Add("(LENGTH_UNIT()NAMED_UNIT(*)" + net.unit + ")");
  const int angle = writer.Add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int solid_angle = writer.Add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int context =
      writer.Add("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((" + Reference(length) +
                 "," + Reference(angle) + "," + Reference(solid_angle) + "))REPRESENTATION_CONTEXT('',''))");
  const int shape = writer.Add("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(" + Reference(model) + ")," +
                               Reference(context) + ")");
  const int application = writer.Add("APPLICATION_CONTEXT('automotive design')");
  const int product_context = writer.Add("PRODUCT_CONTEXT(''," + Reference(application) + ",'mechanical')");
  const int product = writer.Add("PRODUCT('net','net','',(" + Reference(product_context) + "))");
  const int formation = writer.Add("PRODUCT_DEFINITION_FORMATION('',''," + Reference(product) + ")");
  const int design =
      writer.Add("PRODUCT_DEFINITION_CONTEXT('part definition'," + Reference(application) + ",'design')");
  const int definition =
      writer.Add("PRODUCT_DEFINITION('design',''," + Reference(formation) + "," + Reference(design) + ")");
  const int defined = writer.Add("PRODUCT_DEFINITION_SHAPE('',''," + Reference(definition) + ")");
  writer.Add("SHAPE_DEFINITION_REPRESENTATION(" + Reference(defined) + "," + Reference(shape) + ")");
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('net','2026-01-01T00:00:00',(''),("
         "''),'','','');\n"
         "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n" +
         writer.text() + "ENDSEC;\nEND-ISO-10303-21;\n";
}

KnotVector Clamped(int degree) {
  return {{degree + 1, degree + 1}, {0, 1}};
}

// Formats a number as a person would write it.
std::string Short(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

// Returns weights of 1, except for one inner control point.
std::function<double(int, int)> Inner(double weight) {
  return [=](int i, int j) { return i == 1 && j == 2 ? weight : 1; };
}

}  // namespace

std::vector<StepExtreme> StepExtremes() {
  std::vector<StepExtreme> all;
  const auto add = [&](const std::string& input, const Net& net, Arrival arrival) {
    all.push_back({input, arrival == Arrival::kRendered ? "right" : "a clear error", StepOf(net), arrival});
  };
  for (const double weight : {1e12, 1e-12, 1e-300})
    add("an inner weight of " + Short(weight), {.weight = Inner(weight)}, Arrival::kRendered);
  for (const double weight : {0.0, -1e-12, -1.0})
    add("an inner weight of " + Short(weight), {.weight = Inner(weight)}, Arrival::kRefused);
  add("degree 25 × 25", {.degree_u = 25, .degree_v = 25, .u = Clamped(25), .v = Clamped(25)},
      Arrival::kRendered);
  add("degree 26 × 3", {.degree_u = 26, .u = Clamped(26)}, Arrival::kRefused);
  add("two knots 1e-12 apart", {.u = {{4, 1, 1, 4}, {0, 0.5, 0.5 + 1e-12, 1}}}, Arrival::kRendered);
  add("two knots one unit in the last place apart",
      {.u = {{4, 1, 1, 4}, {0, 0.5, std::nextafter(0.5, 1.0), 1}}}, Arrival::kRendered);
  add("an interior knot of multiplicity 3, degree 3", {.u = {{4, 3, 4}, {0, 0.5, 1}}}, Arrival::kRendered);
  add("an interior knot of multiplicity 4, degree 3: torn", {.u = {{4, 4, 4}, {0, 0.5, 1}}},
      Arrival::kRefused);
  add("10 kilometres", {.size = 10, .unit = "SI_UNIT(.KILO.,.METRE.)"}, Arrival::kRendered);
  add("10 micrometres", {.size = 10, .unit = "SI_UNIT(.MICRO.,.METRE.)"}, Arrival::kRendered);
  add("a coordinate of 1e300 mm", {.corner = "1.E300,0.,0."}, Arrival::kRefused);
  add("a coordinate of 1e400 mm", {.corner = "1.E400,0.,0."}, Arrival::kRefused);
  add("a denormal coordinate", {.corner = "1.E-310,0.,0."}, Arrival::kRendered);
  return all;
}

StepMeasurement MeasureStep(const StepExtreme& extreme) {
  StepMeasurement result;
  const TempDir directory = TempDir::Create().value();
  ImportRequest request;
  request.input = WriteText(directory.File("extreme.step"), extreme.text);
  request.limits.timeout_s = 30;
  const Result<ImportedFiles> files = RunImporter(request);
  Model model;
  if (!files.ok()) {
    result.refusal = std::string(ErrorCodeName(files.error().code)) + ": " + files.error().message;
  } else if (Result<Model> read = ReadModel(files.value().model_path); !read.ok()) {
    result.refusal = read.error().message;
  } else {
    model = std::move(read).value();
    for (const auto* losses : {&model.info.faces_lost, &model.info.loops_lost, &model.info.edges_lost})
      for (const Loss& loss : *losses) result.refusal += "lost: " + loss.reason + " ";
  }
  if (!result.refusal.empty()) {
    if (extreme.arrival == Arrival::kRendered) result.failures.push_back("refused: " + result.refusal);
    return result;
  }
  if (extreme.arrival == Arrival::kRefused) result.failures.push_back("rendered, though it can't be");
  Extreme rendered;
  rendered.group = "import";
  rendered.input = extreme.input;
  rendered.model = [&] { return model; };
  rendered.cameras = [](const Model& placed) { return NamedViews(placed, {"iso", "top"}, 32); };
  rendered.certified = {0.4, 0.4, 0.4};
  rendered.doubts = 0xff & ~kDoubtCoincident;
  rendered.depth_bound_mm = 1e-2 * model.Diagonal();
  rendered.judged = 12;
  result.measurement = Measure(rendered);
  result.failures.insert(result.failures.end(), result.measurement.failures.begin(),
                         result.measurement.failures.end());
  return result;
}

}  // namespace facetless::extremes
