// What the fuzz targets share.
//
//  1. A target is one function, LLVMFuzzerTestOneInput: any bytes, no answer. It ends the process where a
//     promise is broken.
//  2. Built by the preset `fuzz` (tools/fuzz), libFuzzer calls it; in other builds driver.cpp does, with
//     seeds and mutants of them.
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

// For readers of files.
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
