// facetless-plain-read reads a STEP or IGES file with OpenCASCADE's own reader and does nothing else. The bench
// compares the processor time of facetless-import with that of this program.
//
//     facetless-plain-read FILE [--unhealed FOLDER]
//
// Without --unhealed, the reader has the configuration that a program gets that sets nothing. With it, shapes
// are transferred as the file has them; FOLDER is an empty folder for the resource files that say so.
//
// Standard output is one JSON object. Exit status: 0 read, 4 nothing usable, 64 bad usage.
#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "render/base/stopwatch.h"

namespace facetless {
namespace {

constexpr int kExitDone = 0, kExitNothingUsable = 4, kExitUsage = 64;

// The sequences of operations after a transfer are empty, and OpenCASCADE finds them in this folder.
void TurnHealingOff(const std::string& folder) {
  std::ofstream(folder + "/STEP") << "FromSTEP.exec.op :\n";
  std::ofstream(folder + "/IGES") << "FromIGES.exec.op :\n";
  setenv("CSF_STEPDefaults", folder.c_str(), 1);
  setenv("CSF_IGESDefaults", folder.c_str(), 1);
}

// A STEP file names its standard at the beginning.
bool IsStep(const char* path) {
  constexpr std::size_t kBeginning = 4096;
  std::ifstream file(path, std::ios::binary);
  std::string text(kBeginning, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text.find("ISO-10303-21") != std::string::npos;
}

template <typename Reader>
int Read(const char* path) {
  Reader reader;
  const Stopwatch reading;
  if (reader.ReadFile(path) != IFSelect_RetDone) return kExitNothingUsable;
  const double read_ms = reading.Milliseconds();
  const Stopwatch transferring;
  reader.TransferRoots();
  std::printf("{\"read_ms\": %.3f, \"transfer_ms\": %.3f, \"shapes\": %d}\n", read_ms,
              transferring.Milliseconds(), reader.NbShapes());
  return reader.NbShapes() > 0 ? kExitDone : kExitNothingUsable;
}

int Run(int count, char** arguments) {
  const bool unhealed = count == 4 && std::string_view(arguments[2]) == "--unhealed";
  if (count != 2 && !unhealed) {
    std::fprintf(stderr, "usage: facetless-plain-read FILE [--unhealed FOLDER]\n");
    return kExitUsage;
  }
  if (unhealed) TurnHealingOff(arguments[3]);
  // Messages go to standard output, which is reserved for the JSON.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    return IsStep(arguments[1]) ? Read<STEPControl_Reader>(arguments[1])
                                : Read<IGESControl_Reader>(arguments[1]);
  } catch (const Standard_Failure&) {
    return kExitNothingUsable;
  }
}

}  // namespace
}  // namespace facetless

int main(int count, char** arguments) {
  const int status = facetless::Run(count, arguments);
  // Destructors of OpenCASCADE's static objects may crash (import/main.cpp).
  std::fflush(nullptr);
  std::_Exit(status);
}
