// Image files: PNG with libpng, TIFF with libtiff, and EXR with OpenEXR.
//
//     if (Result<void> written = WritePng("view.png", image); !written) return written.error();
//     Result<DepthImage> depth = ReadDepth("view.depth.tif");
//
//  1. A file is written completely or not at all: it is written under a temporary name in the same directory
//     and then renamed.
//  2. PNG files are 8-bit sRGB, not multiplied by alpha. Depth is a TIFF file with one float64 channel, +inf
//     where nothing is hit. AOVs are one EXR file with named channels.
//  3. No file contains a date or the name of a machine, so the same picture gives the same bytes.
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
// Writes an RGB picture whose bytes are numbers. The file states no colour space, so readers do not convert
// the bytes. The compression is fast rather than strong, because there are many data planes and half of their
// bytes do not compress.
Result<void> WriteDataPng(const std::string& path, const Image8& image);
// The same file as bytes, with strong compression.
Result<std::string> EncodeDataPng(const Image8& image);
// Reads a PNG file. Grey images are converted to RGB, and 16-bit images are rounded to 8 bits.
Result<Image8> ReadPng(const std::string& path);

struct DepthImage {
  int width = 0, height = 0;
  std::vector<double, LargePages<double>> depth;  // mm; +inf for a miss
};
Result<void> WriteDepth(const std::string& path, int width, int height, std::span<const double> depth);
// Reads a depth image; float32 TIFF files are accepted, too. The values are returned unchanged, NaN included;
// the comparison functions reject NaN.
Result<DepthImage> ReadDepth(const std::string& path);

// The AOVs to write.
struct AovSelection {
  bool depth = true, normal = true, face = true, uv = false, certificate = false;
  const std::vector<float>* curvature = nullptr;  // mean curvature, 1/mm; null: not written
};
// Channels: depth.Z (float32 of the depth), normal.X/Y/Z, face.id (uint32; 4294967295: none), uv.U/V,
// certificate.C (uint32: 0 certified, 1 converged, 2 unresolved), certificate.doubt (uint32: bits of
// render/view/doubt.h) and certificate.error (float32: bound of the depth's error, mm), curvature.H.
// Error: kBadUsage (the samples lack a selected AOV).
Result<void> WriteAovs(const std::string& path, const SampleBuffer& samples, const AovSelection& aovs);

}  // namespace facetless
