// Pictures that are slices of voxels: PNG files, and TIFF files of one or many pages.
//
//     Result<TiffPages> pages = TiffPages::Open("stack.tif");
//     for (int page = 0; page < pages.value().count(); ++page) Use(pages.value().Read(page, 0, max_bytes));
//
//  1. A slice is an Image8 with four channels, whose alpha is 255 where the picture is filled and 0 where it is empty.
//  2. A pixel with alpha is empty if its alpha is 0. One without alpha is empty if no channel is above `threshold`, in the
//     numbers of the file: up to 255 with 8 bits, up to 65,535 with 16 bits, anything with 32 bits. One bit is 0 or 1 in TIFF,
//     and 0 or 255 in PNG.
//  3. Colours of 16 bits are cut to 8. Those of other numbers than 8 and 16 bits are an even grey.
//  4. A picture whose pixels need more than `max_bytes` is not read (kLimitExceeded).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

// Errors: kFileUnreadable, kFormatUnknown, kFormatBroken, kLimitExceeded.
Result<Image8> ReadPngSlice(const std::string& path, double threshold, std::uint64_t max_bytes);

class TiffPages {
 public:
  // Errors: kFileUnreadable, kFormatUnknown, kFormatBroken, kLimitExceeded (more than 65,536 pages).
  static Result<TiffPages> Open(const std::string& path, std::uint64_t max_bytes);
  int count() const;
  // Reads the next page. The pages may be of whole numbers of 1, 8, 16 or 32 bits, or of floating-point numbers of 32 bits;
  // grey, or red, green and blue, or either with alpha; in strips or tiles. Errors: kFormatBroken (the message names the
  // page), kLimitExceeded.
  Result<Image8> Next(double threshold, std::uint64_t max_bytes);

  TiffPages(TiffPages&&) noexcept;
  ~TiffPages();

 private:
  struct File;
  explicit TiffPages(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

// Writes slices as the pages of one file, compressed with Deflate. The file appears under its name with Finish.
class TiffPageWriter {
 public:
  // `pixels`: of all pages, from which the kind of the file follows. Error: kWriteFailed.
  static Result<TiffPageWriter> Open(const std::string& path, double pixels);
  Result<void> Add(const Image8& slice);
  Result<void> Finish();

  TiffPageWriter(TiffPageWriter&&) noexcept;
  ~TiffPageWriter();

 private:
  struct File;
  explicit TiffPageWriter(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace facetless
