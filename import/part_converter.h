// Appends the faces of one prototype to a model.
#pragma once

#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "import/document.h"
#include "import/face_loops.h"
#include "render/model/model.h"

namespace facetless {

class PartConverter {
 public:
  PartConverter(const CadDocument& document, const Prototype& prototype, Model& model,
                std::vector<TopoDS_Face>& faces)
      : document_(document), prototype_(prototype), model_(model), faces_(faces) {}

  // Appends the part, its faces, loops, edges, vertices and solids. `done` is called after each face.
  template <typename Done>
  void Run(Done done) {
    Begin();
    for (const Member& member : members_) {
      AddFace(member);
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
  // The faces of a solid, or of a shell that may be closed without being called a solid.
  struct Group {
    bool solid;
    std::string name;
  };

  void Begin();
  void End();
  void Gather(const TopoDS_Shape& shape, int group);
  void AddFace(const Member& member);
  void LoseFace(const TopoDS_Face& face, const std::string& reason);
  std::uint32_t StoreSurface(PatchGrid grid);
  void StoreLoop(const FaceLoop& loop);
  std::uint32_t EdgeIndex(const TopoDS_Edge& edge);
  std::uint32_t VertexIndex(const TopoDS_Shape& vertex);
  double PolygonLength(const Edge& edge) const;
  std::string FaceName(std::uint32_t index) const;
  void WarnOfGaps(std::uint32_t face);
  void CheckAgainstFile(std::uint32_t face, const FaceLoops& loops);
  const FaceOrigin* OriginOf(const TopoDS_Face& face) const;
  bool HasLosses(std::uint32_t face) const;
  bool IsClosed(int group) const;

  const CadDocument& document_;
  const Prototype& prototype_;
  Model& model_;
  std::vector<TopoDS_Face>& faces_;
  std::vector<Member> members_;
  std::vector<Group> groups_;
  std::vector<int> face_groups_;  // of the part's converted faces
  std::uint32_t first_face_ = 0, first_edge_ = 0;
  TopTools_DataMapOfShapeInteger edge_index_, vertex_index_;
};

}  // namespace facetless
