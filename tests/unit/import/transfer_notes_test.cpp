// OpenCASCADE's translation is reported while it runs, entity by entity.
#include "import/transfer_notes.h"

#include <gtest/gtest.h>

#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <XSControl_TransferReader.hxx>
#include <set>

#include "tests/support/files.h"

namespace facetless {
namespace {

TEST(TransferNotes, TellEachFaceOfAStepFile) {
  STEPControl_Reader reader;
  ASSERT_EQ(reader.ReadFile(Sample("bracket.step").c_str()), IFSelect_RetDone);
  std::vector<Handle(Standard_Transient)> told;
  const Handle(TransferNotes) notes = new TransferNotes(
      reader.WS(), [&](const Handle(Standard_Transient) & entity) { told.push_back(entity); });
  reader.TransferRoots(notes->Start());
  std::set<int> faces;
  for (const Handle(Standard_Transient) & entity : told) {
    EXPECT_GT(reader.Model()->Number(entity), 0) << "an entity that is not of the file";
    if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) faces.insert(reader.Model()->Number(entity));
  }
  EXPECT_EQ(faces.size(), 30u) << "the bracket's";
}

TEST(TransferNotes, TellTheEntitiesOfAnIgesFile) {
  IGESControl_Reader reader;
  ASSERT_EQ(reader.ReadFile(Sample("trimmed.iges").c_str()), IFSelect_RetDone);
  std::set<int> entities;
  const Handle(TransferNotes) notes = new TransferNotes(
      reader.WS(),
      [&](const Handle(Standard_Transient) & entity) { entities.insert(reader.Model()->Number(entity)); });
  reader.TransferRoots(notes->Start());
  EXPECT_GE(entities.size(), 3u);
}

}  // namespace
}  // namespace facetless
