// What OpenCASCADE has translated last, told whenever it reports progress: its transfers tell nobody what
// they are at, and this is as near as their bookkeeping comes. It costs a look at a counter per report.
#pragma once

#include <Message_ProgressIndicator.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_WorkSession.hxx>
#include <functional>
#include <utility>

namespace facetless {

class TransferNotes : public Message_ProgressIndicator {
 public:
  // `note` gets each entity of the file that is new; `session` is that of the reader that transfers.
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
