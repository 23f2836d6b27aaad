// Image files: PNG through libpng, TIFF through libtiff, EXR through OpenEXR, one file each.
//
//  1. A file appears in full or not at all: it is written under a temporary name beside its own and
//     renamed.
//  2. PNG is 8-bit sRGB; alpha is not multiplied in. Depth is one channel of float64 in TIFF, +inf where
//     nothing is hit. AOVs are one EXR file with named channels.
//  3. No file carries a date or a machine's name: the same picture gives the same bytes.
//  4. Errors name the path: kWriteFailed (absent directory, no permission, disk full), kFileUnreadable,
//     kFormatBroken, kFormatUnknown, kLimitExceeded (more than 65,536 pixels on a side).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/base/large_pages.h"
#include "render/base/result.h"
#include "render/image/film.h"
#include "render/view/samples.h"

namespace facetless {

Result<void> WritePng(const std::string& path, const Image8& image);
// An RGB picture whose bytes are numbers: no colour space is named, so no reader converts them. Packed
// lightly: planes of data are many, and half of their bytes don't compress.
Result<void> WriteDataPng(const std::string& path, const Image8& image);
// The same as bytes, packed well.
Result<std::string> EncodeDataPng(const Image8& image);
// Grey images come back as RGB, 16-bit ones rounded to 8.
Result<Image8> ReadPng(const std::string& path);

struct DepthImage {
  int width = 0, height = 0;
  std::vector<double, LargePages<double>> depth;  // mm; +inf: nothing hit
};
Result<void> WriteDepth(const std::string& path, int width, int height, std::span<const double> depth);
// Also reads TIFF files of float32. Numbers are returned as they are, NaN included: comparing is what
// refuses them.
Result<DepthImage> ReadDepth(const std::string& path);

// Which AOVs a file holds, besides those that are always there.
struct AovSelection {
  bool depth = true, normal = true, face = true, uv = false, certificate = false;
  const std::vector<float>* curvature = nullptr;  // mean curvature, 1/mm, if somebody computed it
};
// Channels: depth.Z (float32 of the depth), normal.X/Y/Z, face.id (uint32; 4294967295: none), uv.U/V,
// certificate.C (uint32: 0 certified, 1 converged, 2 unresolved), certificate.doubt (uint32: bits of
// render/view/doubt.h) and certificate.error (float32: bound of the depth's error, mm), curvature.H.
// kBadUsage if an AOV is asked for that the samples don't hold.
Result<void> WriteAovs(const std::string& path, const SampleBuffer& samples, const AovSelection& aovs);

}  // namespace facetless
