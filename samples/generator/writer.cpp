#include "samples/generator/writer.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>

namespace facetless::samples {
namespace {

// `assembly`: 0 writes a compound as one product, 1 as an assembly.
void SetStepOptions(int assembly) {
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetIVal("write.surfacecurve.mode", 1);
  Interface_Static::SetIVal("write.step.assembly", assembly);
  // The file states the smallest tolerance of the shape, so that a reader uses no larger one.
  Interface_Static::SetIVal("write.precision.mode", -1);
}

Handle(TCollection_HAsciiString) Text(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

void WriteStepFile(STEPControl_Writer& writer, const std::string& name, const std::string& path) {
  APIHeaderSection_MakeHeader header(writer.Model());
  header.SetName(Text(name));
  header.SetTimeStamp(Text("2026-01-01T00:00:00"));
  header.SetAuthorValue(1, Text("Facetless"));
  header.SetOrganizationValue(1, Text("Facetless"));
  header.SetPreprocessorVersion(Text("Open CASCADE"));
  header.SetOriginatingSystem(Text("facetless-samples"));
  header.SetAuthorisation(Text(""));
  if (writer.Write(path.c_str()) != IFSelect_RetDone)
    throw Standard_Failure(("cannot write " + path).c_str());
}

}  // namespace

void WriteStep(const TopoDS_Shape& shape, const std::string& name, const std::string& path) {
  SetStepOptions(0);
  STEPControl_Writer writer;
  if (writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone) {
    throw Standard_Failure(("cannot convert " + name).c_str());
  }
  // OpenCASCADE continues the numbers of products from earlier files of the process.
  const Handle(StepData_StepModel) model = writer.Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(StepBasic_Product) product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    product->SetId(Text(name));
    product->SetName(Text(name));
  }
  WriteStepFile(writer, name, path);
}

void WriteStep(const Handle(TDocStd_Document) & document, const std::string& name, const std::string& path) {
  SetStepOptions(1);
  STEPCAFControl_Writer writer;
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  if (!writer.Transfer(document, STEPControl_AsIs))
    throw Standard_Failure(("cannot convert " + name).c_str());
  WriteStepFile(writer.ChangeWriter(), name, path);
}

void WriteIges(const TopoDS_Shape& shape, const std::string& name, const std::string& path) {
  IGESControl_Controller::Init();
  Interface_Static::SetCVal("write.iges.header.author", "Facetless");
  Interface_Static::SetCVal("write.iges.header.company", "Facetless");
  constexpr int kTrimmedSurfaces = 0;
  IGESControl_Writer writer("MM", kTrimmedSurfaces);
  if (!writer.AddShape(shape)) throw Standard_Failure(("cannot convert " + name).c_str());
  writer.ComputeModel();

  IGESData_GlobalSection global = writer.Model()->GlobalSection();
  global.SetSendName(Text(name));
  global.SetFileName(Text(name));
  global.SetSystemId(Text("facetless-samples"));
  global.SetInterfaceVersion(Text("Open CASCADE"));
  global.SetReceiveName(Text(name));
  global.SetDate(Text("20260101.000000"));
  global.SetLastChangeDate(Text("20260101.000000"));
  writer.Model()->SetGlobalSection(global);
  if (!writer.Write(path.c_str())) throw Standard_Failure(("cannot write " + path).c_str());
}

}  // namespace facetless::samples
