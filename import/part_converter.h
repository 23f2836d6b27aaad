// Adds one prototype to a model: its part, faces, edges and solids.
#pragma once

#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS_Face.hxx>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "import/document.h"
#include "import/face_loops.h"
#include "import/heal.h"
#include "render/model/builder.h"

namespace facetless {

class PartConverter {
 public:
  // `loops` contains the loops that are already known.
  PartConverter(const CadDocument& document, const Prototype& prototype, const LoopsByFace& loops,
                ModelBuilder& builder, std::vector<TopoDS_Face>& faces)
      : document_(document), prototype_(prototype), loops_(loops), builder_(builder), faces_(faces) {}

  // Appends the part, its faces, loops, edges, vertices and solids. `done` is called after each face.
  template <typename Done>
  void Run(Done done) {
    Begin();
    for (std::size_t i = 0; i < members_.size(); ++i) {
      AddFace(i);
      done();
    }
    End();
  }

  std::size_t face_count() const { return members_.size(); }

 private:
  struct Member {
    TopoDS_Face face;
    int group;  // index into groups_, or −1
  };
  // The faces of a solid, or of a shell that may be closed although the file does not call it a solid.
  struct Group {
    bool solid;
    std::string name;
  };

  // The parts of a face of the file that have been converted, over all its pieces.
  struct Arrived {
    const FaceOrigin* origin = nullptr;
    std::vector<std::uint32_t> faces;
    TopTools_MapOfShape edges;
    int loops = 0;
    int mended = 0;  // edges that were removed on purpose
  };

  void Begin();
  void End();
  void Gather(const TopoDS_Shape& shape, int group);
  void AddFace(std::size_t index);
  // Converts `shape`, which replaces the member's face. Returns an empty string, or the reason for the
  // failure.
  std::string TryFace(const Member& member, const TopoDS_Face& shape);
  // Returns the face in one piece, without edges that are followed forwards and backwards. Returns null if
  // the face has no such edges, or if nothing remains without them.
  TopoDS_Face Mended(std::size_t index);
  void LoseFace(const TopoDS_Face& face, const std::string& reason);
  void StoreLoops(const FaceLoops& loops, const std::vector<std::uint32_t>& edges);
  std::vector<std::uint32_t> EdgesOf(const FaceLoops& loops);
  std::uint32_t EdgeIndex(const TopoDS_Edge& edge);
  std::uint32_t VertexIndex(const TopoDS_Shape& vertex);
  std::string FaceName(std::uint32_t index) const;
  void WarnOfGaps(std::uint32_t face);
  void WarnOfCrossings(std::uint32_t face, const FaceLoops& loops, const TopoDS_Face& shape);
  void WarnOfOpening(std::uint32_t face, const FaceLoops& loops);
  void NoteLoops(std::uint32_t face, const FaceOrigin* origin, const FaceLoops& loops);
  void CheckAgainstFile();
  const FaceOrigin* OriginOf(const TopoDS_Face& face) const;
  bool SameOrigin(const TopoDS_Face& face, const FaceOrigin& origin) const;
  bool HasLosses(std::uint32_t face) const;
  bool IsClosed(int group) const;
  void WarnOfTurning(int group);

  const Model& model() const { return builder_.model(); }
  void Warn(std::string sentence) { builder_.info().warnings.push_back(std::move(sentence)); }

  const CadDocument& document_;
  const Prototype& prototype_;
  const LoopsByFace& loops_;
  ModelBuilder& builder_;
  std::vector<TopoDS_Face>& faces_;
  std::vector<Member> members_;
  std::vector<bool> stored_;  // for each member: it is converted, or a piece of a face that was mended
  std::vector<Group> groups_;
  std::vector<Arrived> arrived_;                             // of the part's faces, in order
  std::unordered_map<std::string, std::size_t> arrived_of_;  // by entity
  int mended_edges_ = 0;          // edges that were removed from the face that is being mended
  std::vector<int> face_groups_;  // of the part's converted faces
  std::uint32_t first_face_ = 0;
  TopTools_DataMapOfShapeInteger edge_index_, vertex_index_;
};

}  // namespace facetless
