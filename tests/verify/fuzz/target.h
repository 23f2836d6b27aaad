// Shared by the fuzz targets.
//
//  1. A target is one function, LLVMFuzzerTestOneInput, that accepts any bytes. It ends the process if a
//     promise is broken.
//  2. In builds with the preset `fuzz` (tools/fuzz), libFuzzer calls it. In other builds, driver.cpp calls it
//     with seeds and mutants of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "server/base/temp_dir.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace facetless {

inline std::string_view Text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

inline void Require(bool promise) {
  if (!promise) std::abort();
}

// A file that contains the input, for readers of files.
class InputFile {
 public:
  InputFile() : directory_(TempDir::Create("/dev/shm").value()) {}
  std::string Write(const std::uint8_t* data, std::size_t size) const {
    const std::string path = directory_.File("input");
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
  }

 private:
  TempDir directory_;
};

}  // namespace facetless
