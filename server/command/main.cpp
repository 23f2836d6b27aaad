#include "server/command/cli.h"

int main(int argc, char** argv) {
  return facetless::RunCommandLine(argc, argv);
}
