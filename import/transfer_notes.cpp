#include "import/transfer_notes.h"

#include <XSControl_TransferReader.hxx>

namespace facetless {

Standard_Boolean TransferNotes::UserBreak() {
  CollectNewNotes();
  return false;
}

void TransferNotes::Show(const Message_ProgressScope&, const Standard_Boolean) {
  CollectNewNotes();
}

void TransferNotes::CollectNewNotes() {
  const Handle(Transfer_TransientProcess) process = session_->TransferReader()->TransientProcess();
  if (process.IsNull() || process->NbMapped() == known_) return;
  // A new transfer begins with an empty map.
  known_ = process->NbMapped();
  if (known_ > 0) note_(process->Mapped(known_));
}

}  // namespace facetless
