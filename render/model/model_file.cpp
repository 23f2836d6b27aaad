#include "render/model/model_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <span>
#include <unordered_map>

#include "render/model/model_generated.h"

namespace facetless {
namespace {

static_assert(std::endian::native == std::endian::little, "bulk vectors are copied as they lie in the file");
static_assert(sizeof(Vec3) == sizeof(file::Vec3) && sizeof(Vec4) == sizeof(file::Vec4));

// The limit of FlatBuffers, whose offsets are signed 32-bit numbers.
constexpr std::uint64_t kMaxFileBytes = 0x7fffffffu - 65536;

// The strings of a model, each stored once. Index 0 is the empty string.
class StringTable {
 public:
  std::uint32_t Add(const std::string& text) {
    const auto [entry, added] = index_.try_emplace(text, static_cast<std::uint32_t>(strings_.size()));
    if (added) strings_.push_back(text);
    return entry->second;
  }
  const std::vector<std::string>& strings() const { return strings_; }

 private:
  std::vector<std::string> strings_{""};
  std::unordered_map<std::string, std::uint32_t> index_{{"", 0}};
};

file::Range Pack(Range range) {
  return {range.first, range.count};
}
Range Unpack(const file::Range& range) {
  return {range.first(), range.count()};
}
file::Color Pack(const Color& color) {
  return {color.r, color.g, color.b, color.a};
}
Color Unpack(const file::Color& color) {
  return {color.r(), color.g(), color.b(), color.a()};
}
file::Row PackRow(const double (&row)[4]) {
  return {row[0], row[1], row[2], row[3]};
}
void UnpackRow(const file::Row& row, double (&out)[4]) {
  out[0] = row.x();
  out[1] = row.y();
  out[2] = row.z();
  out[3] = row.t();
}

// Copies a vector of structs that have the same layout in memory and in the file.
template <typename Packed, typename T>
auto PackBulk(flatbuffers::FlatBufferBuilder& builder, const std::vector<T>& items) {
  return builder.CreateVectorOfStructs(reinterpret_cast<const Packed*>(items.data()), items.size());
}

template <typename Packed, typename T, typename Function>
auto PackEach(flatbuffers::FlatBufferBuilder& builder, const std::vector<T>& items, Function pack) {
  std::vector<Packed> packed;
  packed.reserve(items.size());
  for (const T& item : items) packed.push_back(pack(item));
  return builder.CreateVectorOfStructs(packed);
}

template <typename T, typename Packed>
std::vector<T> UnpackBulk(const flatbuffers::Vector<const Packed*>* items) {
  std::vector<T> out(items->size());
  if (!out.empty()) std::memcpy(out.data(), items->Data(), out.size() * sizeof(T));
  return out;
}

template <typename T, typename Packed, typename Function>
std::vector<T> UnpackEach(const flatbuffers::Vector<const Packed*>* items, Function unpack) {
  std::vector<T> out;
  if (!items) return out;
  out.reserve(items->size());
  // Copy each struct, because the verifier does not guarantee that the structs of a vector are aligned.
  for (std::size_t i = 0; i < items->size(); ++i) {
    Packed item;
    std::memcpy(&item, items->Data() + i * sizeof(Packed), sizeof(Packed));
    out.push_back(unpack(item));
  }
  return out;
}

flatbuffers::Offset<file::ImportInfo> PackInfo(flatbuffers::FlatBufferBuilder& builder,
                                               const ImportInfo& info, StringTable& strings) {
  const auto pack_loss = [&](const Loss& loss) {
    return file::Loss(loss.face, strings.Add(loss.name), strings.Add(loss.entity), strings.Add(loss.reason));
  };
  const auto faces_lost = PackEach<file::Loss>(builder, info.faces_lost, pack_loss);
  const auto loops_lost = PackEach<file::Loss>(builder, info.loops_lost, pack_loss);
  const auto edges_lost = PackEach<file::Loss>(builder, info.edges_lost, pack_loss);
  const auto approximated = PackEach<file::Approximation>(
      builder, info.approximated,
      [](const Approximation& a) { return file::Approximation(a.face, a.deviation_mm); });
  const auto healed = PackEach<file::HealedBody>(builder, info.healed, [&](const HealedBody& body) {
    return file::HealedBody(strings.Add(body.name), strings.Add(body.entity), strings.Add(body.reason),
                            body.faces, body.faces_changed, body.edges_changed, body.pcurves_changed,
                            body.moved_mm);
  });
  std::vector<std::uint32_t> warnings;
  for (const std::string& warning : info.warnings) warnings.push_back(strings.Add(warning));
  return file::CreateImportInfo(
      builder, strings.Add(info.file), strings.Add(info.sha256), strings.Add(info.format),
      strings.Add(info.unit), info.unit_mm, info.faces_declared, info.faces_imported, faces_lost, loops_lost,
      edges_lost, approximated, builder.CreateVector(warnings), info.read_ms, info.transfer_ms,
      info.convert_ms, info.peak_bytes, info.max_edge_gap_mm, strings.Add(info.max_edge_gap_entity), healed);
}

void PackModel(flatbuffers::FlatBufferBuilder& builder, const Model& model) {
  StringTable strings;
  const auto info = PackInfo(builder, model.info, strings);
  const auto control_points = PackBulk<file::Vec4>(builder, model.control_points);
  const auto spans = PackEach<file::Span>(builder, model.spans, [](const Span& s) {
    return file::Span(s.begin, s.end, static_cast<std::uint8_t>(s.map));
  });
  const auto surfaces = PackEach<file::Surface>(builder, model.surfaces, [](const Surface& s) {
    return file::Surface(static_cast<std::uint8_t>(s.kind), s.degree_u, s.degree_v, s.rational,
                         s.extendable_u, s.extendable_v, s.period_u, s.period_v, Pack(s.u_spans),
                         Pack(s.v_spans), s.first_control_point);
  });
  const auto trim_points = PackBulk<file::Vec3>(builder, model.trim_points);
  const auto trim_segments =
      PackEach<file::TrimSegment>(builder, model.trim_segments, [](const TrimSegment& s) {
        return file::TrimSegment(s.degree, s.first_point, s.edge_begin, s.edge_end);
      });
  const auto coedges = PackEach<file::Coedge>(builder, model.coedges, [](const Coedge& c) {
    return file::Coedge(c.edge, c.reversed, c.from_file, Pack(c.segments), c.gap_mm);
  });
  const auto loops =
      PackEach<file::Loop>(builder, model.loops, [](const Loop& l) { return file::Loop(Pack(l.coedges)); });
  const auto edge_points = PackBulk<file::Vec4>(builder, model.edge_points);
  const auto edge_segments = PackEach<file::EdgeSegment>(
      builder, model.edge_segments,
      [](const EdgeSegment& s) { return file::EdgeSegment(s.degree, s.first_point, s.begin, s.end); });
  const auto edges = PackEach<file::Edge>(builder, model.edges, [&](const Edge& e) {
    return file::Edge(Pack(e.segments), e.vertices[0], e.vertices[1], e.tolerance_mm, e.degenerate,
                      e.coedge_count, strings.Add(e.entity));
  });
  const auto vertices = PackEach<file::Vertex>(builder, model.vertices, [](const Vertex& v) {
    return file::Vertex({v.point.x, v.point.y, v.point.z}, v.tolerance_mm);
  });
  const auto faces = PackEach<file::Face>(builder, model.faces, [&](const Face& f) {
    return file::Face(f.surface, Pack(f.loops), f.reversed, f.solid, f.has_color, Pack(f.color),
                      f.tolerance_mm, strings.Add(f.name), strings.Add(f.entity));
  });
  const auto solids = PackEach<file::Solid>(builder, model.solids, [&](const Solid& s) {
    return file::Solid(s.part, s.closed, strings.Add(s.name));
  });
  const auto parts = PackEach<file::Part>(builder, model.parts, [&](const Part& p) {
    return file::Part(strings.Add(p.name), Pack(p.faces), Pack(p.solids));
  });
  const auto instances = PackEach<file::Instance>(builder, model.instances, [&](const Instance& i) {
    const auto& m = i.placement.m;
    return file::Instance(i.part, {PackRow(m[0]), PackRow(m[1]), PackRow(m[2])}, i.has_color, Pack(i.color),
                          strings.Add(i.name), i.first_placed_face, i.hidden);
  });
  // The strings come last: all of the above adds to them.
  const auto string_vector = builder.CreateVectorOfStrings(strings.strings());
  const file::Vec3 low(model.bounds.low.x, model.bounds.low.y, model.bounds.low.z);
  const file::Vec3 high(model.bounds.high.x, model.bounds.high.y, model.bounds.high.z);
  file::FinishModelFileBuffer(
      builder, file::CreateModelFile(builder, info, &low, &high, string_vector, control_points, spans,
                                     surfaces, trim_points, trim_segments, coedges, loops, edge_points,
                                     edge_segments, edges, vertices, faces, solids, parts, instances));
}

// Reads a buffer that the verifier has accepted. The verifier does not check enumerators and string indices,
// so they are checked here.
class Unpacker {
 public:
  explicit Unpacker(const file::ModelFile& in) : in_(in) {}

  Result<Model> Run() {
    Model model;
    UnpackInfo(*in_.info(), model.info);
    model.bounds.low = {in_.bounds_low()->x(), in_.bounds_low()->y(), in_.bounds_low()->z()};
    model.bounds.high = {in_.bounds_high()->x(), in_.bounds_high()->y(), in_.bounds_high()->z()};
    UnpackGeometry(model);
    UnpackTopology(model);
    if (!sound_)
      return Error{ErrorCode::kFormatBroken,
                   "The model file holds an unknown enumerator or a string index out of range."};
    if (Result<void> valid = Validate(model); !valid.ok()) return valid.error();
    return model;
  }

 private:
  std::string Text(std::uint32_t index) {
    if (index < in_.strings()->size()) return in_.strings()->Get(index)->str();
    sound_ = false;
    return {};
  }

  template <typename Enum>
  Enum Enumerator(std::uint8_t value, Enum last) {
    if (value > static_cast<std::uint8_t>(last)) sound_ = false;
    return static_cast<Enum>(value);
  }

  void UnpackInfo(const file::ImportInfo& in, ImportInfo& info) {
    const auto unpack_loss = [&](const file::Loss& l) {
      return Loss{l.face(), Text(l.name()), Text(l.entity()), Text(l.reason())};
    };
    info.file = Text(in.file());
    info.sha256 = Text(in.sha256());
    info.format = Text(in.format());
    info.unit = Text(in.unit());
    info.unit_mm = in.unit_mm();
    info.faces_declared = in.faces_declared();
    info.faces_imported = in.faces_imported();
    info.faces_lost = UnpackEach<Loss>(in.faces_lost(), unpack_loss);
    info.loops_lost = UnpackEach<Loss>(in.loops_lost(), unpack_loss);
    info.edges_lost = UnpackEach<Loss>(in.edges_lost(), unpack_loss);
    info.approximated = UnpackEach<Approximation>(in.approximated(), [](const file::Approximation& a) {
      return Approximation{a.face(), a.deviation_mm()};
    });
    info.healed = UnpackEach<HealedBody>(in.healed(), [&](const file::HealedBody& body) {
      return HealedBody{Text(body.name()),    Text(body.entity()),  Text(body.reason()),    body.faces(),
                        body.faces_changed(), body.edges_changed(), body.pcurves_changed(), body.moved_mm()};
    });
    if (in.warnings()) {
      for (std::uint32_t warning : *in.warnings()) info.warnings.push_back(Text(warning));
    }
    info.read_ms = in.read_ms();
    info.transfer_ms = in.transfer_ms();
    info.convert_ms = in.convert_ms();
    info.peak_bytes = in.peak_bytes();
    info.max_edge_gap_mm = in.max_edge_gap_mm();
    info.max_edge_gap_entity = Text(in.max_edge_gap_entity());
  }

  void UnpackGeometry(Model& model) {
    model.control_points = UnpackBulk<Vec4>(in_.control_points());
    model.spans = UnpackEach<Span>(in_.spans(), [&](const file::Span& s) {
      return Span{s.begin(), s.end(), Enumerator(s.map(), SpanMap::kHalfAngle)};
    });
    model.surfaces = UnpackEach<Surface>(in_.surfaces(), [&](const file::Surface& s) {
      Surface out;
      out.kind = Enumerator(s.kind(), SurfaceKind::kOther);
      out.degree_u = s.degree_u();
      out.degree_v = s.degree_v();
      out.rational = s.rational();
      out.extendable_u = s.extendable_u();
      out.extendable_v = s.extendable_v();
      out.period_u = s.period_u();
      out.period_v = s.period_v();
      out.u_spans = Unpack(s.u_spans());
      out.v_spans = Unpack(s.v_spans());
      out.first_control_point = s.first_control_point();
      return out;
    });
    model.trim_points = UnpackBulk<Vec3>(in_.trim_points());
    model.trim_segments = UnpackEach<TrimSegment>(in_.trim_segments(), [](const file::TrimSegment& s) {
      return TrimSegment{s.degree(), s.first_point(), s.edge_begin(), s.edge_end()};
    });
    model.edge_points = UnpackBulk<Vec4>(in_.edge_points());
    model.edge_segments = UnpackEach<EdgeSegment>(in_.edge_segments(), [](const file::EdgeSegment& s) {
      return EdgeSegment{s.degree(), s.first_point(), s.begin(), s.end()};
    });
  }

  void UnpackTopology(Model& model) {
    model.coedges = UnpackEach<Coedge>(in_.coedges(), [](const file::Coedge& c) {
      return Coedge{c.edge(), c.reversed(), c.from_file(), Unpack(c.segments()), c.gap_mm()};
    });
    model.loops =
        UnpackEach<Loop>(in_.loops(), [](const file::Loop& l) { return Loop{Unpack(l.coedges())}; });
    model.edges = UnpackEach<Edge>(in_.edges(), [&](const file::Edge& e) {
      return Edge{Unpack(e.segments()), {e.vertex0(), e.vertex1()}, e.tolerance_mm(),
                  e.degenerate(),       e.coedge_count(),           Text(e.entity())};
    });
    model.vertices = UnpackEach<Vertex>(in_.vertices(), [](const file::Vertex& v) {
      return Vertex{{v.point().x(), v.point().y(), v.point().z()}, v.tolerance_mm()};
    });
    model.faces = UnpackEach<Face>(in_.faces(), [&](const file::Face& f) {
      return Face{f.surface(),       Unpack(f.loops()), f.reversed(),   f.solid(),       f.has_color(),
                  Unpack(f.color()), f.tolerance_mm(),  Text(f.name()), Text(f.entity())};
    });
    model.solids = UnpackEach<Solid>(in_.solids(), [&](const file::Solid& s) {
      return Solid{s.part(), s.closed(), Text(s.name())};
    });
    model.parts = UnpackEach<Part>(in_.parts(), [&](const file::Part& p) {
      return Part{Text(p.name()), Unpack(p.faces()), Unpack(p.solids())};
    });
    model.instances = UnpackEach<Instance>(in_.instances(), [&](const file::Instance& i) {
      Instance out;
      out.part = i.part();
      UnpackRow(i.placement().row0(), out.placement.m[0]);
      UnpackRow(i.placement().row1(), out.placement.m[1]);
      UnpackRow(i.placement().row2(), out.placement.m[2]);
      out.has_color = i.has_color();
      out.color = Unpack(i.color());
      out.name = Text(i.name());
      out.first_placed_face = i.first_placed_face();
      out.hidden = i.hidden();
      return out;
    });
  }

  const file::ModelFile& in_;
  bool sound_ = true;
};

// A file mapped for reading; empty if it could not be mapped.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return;
    struct stat status {};
    if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) {
      readable_ = true;
      if (status.st_size > 0) {
        void* address = mmap(nullptr, status.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
        if (address != MAP_FAILED)
          bytes_ = {static_cast<const std::uint8_t*>(address), static_cast<std::size_t>(status.st_size)};
        readable_ = address != MAP_FAILED;
      }
    }
    close(descriptor);
  }
  ~MappedFile() {
    if (!bytes_.empty()) munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  bool readable() const { return readable_; }
  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  bool readable_ = false;
  std::span<const std::uint8_t> bytes_;
};

std::uint64_t PackedSize(const Model& model) {
  return model.control_points.size() * sizeof(Vec4) + model.trim_points.size() * sizeof(Vec3) +
         model.edge_points.size() * sizeof(Vec4) + model.spans.size() * sizeof(file::Span) +
         model.surfaces.size() * sizeof(file::Surface) +
         model.trim_segments.size() * sizeof(file::TrimSegment) +
         model.coedges.size() * sizeof(file::Coedge) +
         model.edge_segments.size() * sizeof(file::EdgeSegment) + model.edges.size() * sizeof(file::Edge) +
         model.faces.size() * sizeof(file::Face) + model.instances.size() * (sizeof(file::Instance) + 64);
}

}  // namespace

Result<Model> ReadModel(const std::string& path) {
  const MappedFile file(path);
  if (!file.readable())
    return Error{ErrorCode::kFileUnreadable, "The model file " + path + " cannot be read."};
  const auto bytes = file.bytes();
  // Recognise the format before the verifier turns everything else into "broken".
  if (bytes.size() < 8 || bytes.size() > kMaxFileBytes || !file::ModelFileBufferHasIdentifier(bytes.data()))
    return Error{ErrorCode::kFormatUnknown,
                 path + " is not a model file of this version; import the CAD file again."};
  flatbuffers::Verifier verifier(bytes.data(), bytes.size());
  if (!file::VerifyModelFileBuffer(verifier))
    return Error{ErrorCode::kFormatBroken,
                 "The model file " + path + " is damaged; import the CAD file again."};
  return Unpacker(*file::GetModelFile(bytes.data())).Run();
}

Result<void> WriteModel(const Model& model, const std::string& path) {
  if (Result<void> valid = Validate(model); !valid.ok()) return valid;
  if (PackedSize(model) > kMaxFileBytes)
    return Error{ErrorCode::kWriteFailed, "The model is larger than the 2 GiB that a model file can hold."};
  flatbuffers::FlatBufferBuilder builder(1 << 20);
  PackModel(builder, model);
  // Write a temporary file next to the target and rename it, so that readers see the complete file or none.
  const std::string partial = path + ".partial";
  std::FILE* out = std::fopen(partial.c_str(), "wb");
  if (!out) return Error{ErrorCode::kWriteFailed, "The model file " + path + " cannot be created."};
  const bool written =
      std::fwrite(builder.GetBufferPointer(), 1, builder.GetSize(), out) == builder.GetSize();
  const bool closed = std::fclose(out) == 0;
  if (!written || !closed || std::rename(partial.c_str(), path.c_str()) != 0) {
    std::remove(partial.c_str());
    return Error{ErrorCode::kWriteFailed, "The model file " + path + " cannot be written; is the disk full?"};
  }
  return {};
}

}  // namespace facetless
