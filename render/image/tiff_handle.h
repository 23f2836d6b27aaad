// What all uses of libtiff share: a handle that closes itself, and options that keep the first message.
//
//     std::string failure;                     // must outlive the handle
//     const TiffOptions options = KeepFailures(&failure);
//     const Tiff tiff(TIFFOpenExt(path.c_str(), "r", options.get()));
//
// Only the files that use libtiff include this header.
#pragma once

#include <tiffio.h>

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

namespace facetless {

struct TiffClosed {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Tiff = std::unique_ptr<TIFF, TiffClosed>;
using TiffOptions = std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)>;

// Options with which libtiff stores its first error message in *failure, and prints nothing.
inline TiffOptions KeepFailures(std::string* failure) {
  TiffOptions options(TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree);
  const TIFFErrorHandlerExtR keep = [](TIFF*, void* to, const char*, const char* format, va_list arguments) {
    char message[512];
    std::vsnprintf(message, sizeof message, format, arguments);
    if (auto& text = *static_cast<std::string*>(to); text.empty()) text = message;
    return 1;
  };
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep, failure);
  TIFFOpenOptionsSetWarningHandlerExtR(
      options.get(), [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
  return options;
}

// The value of a field, or its default; 0 without one.
template <typename T>
T TiffField(TIFF* tiff, std::uint32_t tag) {
  T value{};
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : T{};
}

}  // namespace facetless
