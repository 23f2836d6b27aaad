// Reports the entity that OpenCASCADE has translated last, whenever OpenCASCADE reports progress. A transfer
// does not say which entity it is working on; the entities in its map are the closest information. Each
// report costs one look at a counter.
#pragma once

#include <Message_ProgressIndicator.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_WorkSession.hxx>
#include <functional>
#include <utility>

namespace facetless {

class TransferNotes : public Message_ProgressIndicator {
 public:
  // `note` receives each entity of the file that is new. `session` is the session of the reader that
  // transfers.
  TransferNotes(Handle(XSControl_WorkSession) session,
                std::function<void(const Handle(Standard_Transient) &)> note)
      : session_(std::move(session)), note_(std::move(note)) {}

  Standard_Boolean UserBreak() override;
  void Show(const Message_ProgressScope& scope, const Standard_Boolean forced) override;

 private:
  void CollectNewNotes();

  const Handle(XSControl_WorkSession) session_;
  const std::function<void(const Handle(Standard_Transient)&)> note_;
  int known_ = 0;
};

}  // namespace facetless
