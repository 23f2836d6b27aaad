#include "render/view/arrangement.h"

#include <algorithm>
#include <set>
#include <utility>

#include "render/model/bounds.h"
#include "render/nurbs/angle_map.h"

namespace facetless {
namespace {

// The number of names, and of bytes per name, that an error message lists.
constexpr std::size_t kMostNames = 12, kMostNameBytes = 60;

std::string Lowered(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// Returns whether the byte continues a UTF-8 character.
bool Continues(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

// Returns whether the pattern matches the whole of `name`. On a mismatch, the match resumes at the last star.
bool Globs(const std::string& pattern, const std::string& name) {
  std::size_t p = 0, n = 0, star = std::string::npos, after_star = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after_star = n;
    } else if (p < pattern.size() && pattern[p] == '?') {
      ++p;
      do ++n;
      while (n < name.size() && Continues(name[n]));
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++after_star;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + static_cast<std::ptrdiff_t>(p), pattern.end(),
                     [](char c) { return c == '*'; });
}

// Shortens a name from the front, because the end of a path is more informative than its beginning.
std::string Shortened(const std::string& name) {
  if (name.size() <= kMostNameBytes) return name;
  std::size_t begin = name.size() - kMostNameBytes;
  while (begin < name.size() && Continues(name[begin])) ++begin;
  return "…" + name.substr(begin);
}

Error NoSuchPart(const std::string& option, const std::string& pattern,
                 const std::vector<std::string>& names) {
  std::set<std::string> different;
  std::string list;
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (!different.insert(name).second || listed == kMostNames) continue;
    list += (listed++ == 0 ? "" : ", ") + Shortened(name);
  }
  if (different.size() > listed) list += " and " + std::to_string(different.size() - listed) + " more";
  return {ErrorCode::kBadUsage, option + ": no part's name matches \"" + pattern + "\"; there " +
                                    (different.size() == 1 ? "is " : "are ") + list};
}

// Marks the names that at least one of the patterns matches.
Result<std::vector<bool>> Matched(const char* option, const std::vector<std::string>& patterns,
                                  const std::vector<std::string>& names) {
  std::vector<bool> matched(names.size(), false);
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!NameMatches(pattern, names[i])) continue;
      matched[i] = any = true;
    }
    if (!any) return NoSuchPart(option, pattern, names);
  }
  return matched;
}

Placement Moved(Placement placement, Vec3 shift) {
  placement.m[0][3] += shift.x;
  placement.m[1][3] += shift.y;
  placement.m[2][3] += shift.z;
  return placement;
}

}  // namespace

bool ArrangementRequest::HidesAnything(const Model& model) {
  return std::any_of(model.instances.begin(), model.instances.end(),
                     [](const Instance& instance) { return instance.hidden; });
}

std::string OccurrenceName(const Model& model, std::uint32_t instance) {
  const Instance& occurrence = model.instances[instance];
  if (!occurrence.name.empty()) return occurrence.name;
  const std::string& part = model.parts[occurrence.part].name;
  return part.empty() ? "part " + std::to_string(occurrence.part + 1) : part;
}

bool NameMatches(const std::string& pattern, const std::string& name) {
  const std::string wanted = Lowered(pattern), found = Lowered(name);
  if (wanted.find_first_of("*?") != std::string::npos) return Globs(wanted, found);
  return found.find(wanted) != std::string::npos;
}

Result<Arrangement> Arrange(const Model& model, const ArrangementRequest& request) {
  std::vector<std::string> names;
  names.reserve(model.instances.size());
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) names.push_back(OccurrenceName(model, i));
  const auto wanted = Matched("--parts", request.parts, names);
  if (!wanted) return wanted.error();
  const auto hidden = Matched("--hide", request.hide, names);
  if (!hidden) return hidden.error();

  Arrangement arrangement;
  std::size_t left_out = 0;  // number of instances that the file hides
  std::vector<Box3> boxes = InstanceBounds(model, NativeToBezier);
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    if ((!request.parts.empty() && !wanted.value()[i]) || hidden.value()[i]) continue;
    if (model.instances[i].hidden && !request.show_hidden) {
      ++left_out;
      continue;
    }
    boxes[arrangement.shown.size()] = boxes[i];
    arrangement.shown.push_back(i);
  }
  boxes.resize(arrangement.shown.size());
  const Vec3 center = Union(boxes).center();
  for (Box3& box : boxes) {
    const Vec3 shift = box.empty() ? Vec3{} : request.explode * (box.center() - center);
    arrangement.shifts.push_back(shift);
    box = {box.low + shift, box.high + shift};
  }
  arrangement.bounds = Union(boxes);
  if (arrangement.bounds.empty()) {
    if (left_out > 0)
      return Error{ErrorCode::kBadUsage,
                   "the file hides everything that would be shown; use --show-hidden to show it"};
    return Error{ErrorCode::kBadUsage, "--parts and --hide leave nothing to be shown"};
  }
  return arrangement;
}

Model Arranged(const Model& model, const Arrangement& arrangement) {
  Model arranged = model;
  arranged.bounds = arrangement.bounds;
  arranged.instances.clear();
  std::uint32_t next_placed_face = 0;
  for (std::size_t i = 0; i < arrangement.shown.size(); ++i) {
    Instance instance = model.instances[arrangement.shown[i]];
    instance.placement = Moved(instance.placement, arrangement.shifts[i]);
    instance.first_placed_face = next_placed_face;
    next_placed_face += model.parts[instance.part].faces.count;
    arranged.instances.push_back(std::move(instance));
  }
  return arranged;
}

Result<Mesh> Arranged(const Mesh& mesh, const Model& model, const Arrangement& arrangement) {
  if (!mesh.from_model)
    return Error{
        ErrorCode::kBadUsage,
        "--parts, --hide and --explode need Facetless's own mesh, because the parts of another program's "
        "mesh are unknown"};
  // The new index of each instance.
  std::vector<std::uint32_t> place(model.instances.size(), kNoIndex);
  std::vector<std::uint32_t> first_placed_face;
  std::uint32_t next_placed_face = 0;
  for (std::uint32_t i = 0; i < arrangement.shown.size(); ++i) {
    place[arrangement.shown[i]] = i;
    first_placed_face.push_back(next_placed_face);
    next_placed_face += model.parts[model.instances[arrangement.shown[i]].part].faces.count;
  }
  Mesh arranged = mesh;
  arranged.nodes.clear();
  for (MeshNode node : mesh.nodes) {
    if (node.first_placed_face >= model.PlacedFaceCount())
      continue;  // the node belongs to an instance without faces
    const std::uint32_t to = place[model.InstanceOfPlacedFace(node.first_placed_face)];
    if (to == kNoIndex) continue;
    node.placement = Moved(node.placement, arrangement.shifts[to]);
    node.first_placed_face = first_placed_face[to];
    arranged.nodes.push_back(node);
  }
  return arranged;
}

}  // namespace facetless
