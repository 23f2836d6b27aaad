#include "render/shade/certificate_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

#include "render/image/text.h"
#include "render/view/doubt.h"

namespace facetless {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kHit = {214, 218, 222}, kMiss = {255, 255, 255}, kBand = {244, 245, 246};
// Colours that are distinct for all common kinds of colour blindness (Okabe and Ito).
constexpr std::array<Rgb, kDoubtNames.size()> kDoubtColors = {{{86, 180, 233},
                                                               {0, 114, 178},
                                                               {204, 121, 167},
                                                               {0, 158, 115},
                                                               {230, 159, 0},
                                                               {213, 94, 0},
                                                               {240, 228, 66},
                                                               {0, 0, 0}}};

struct Entry {
  Rgb color;
  std::string name;
  std::size_t count;
};

// Draws the legend with one line per entry, in as many columns as fit.
int DrawLegend(Image8* image, int top, double text, const std::vector<Entry>& entries) {
  const TextStyle style{text};
  const int line = static_cast<int>(2 * text), square = static_cast<int>(1.1 * text);
  const auto label = [](const Entry& entry) { return entry.name + " " + std::to_string(entry.count); };
  double x = text, y = top + 0.5 * line;
  for (const Entry& entry : entries) {
    const double width = square + 0.6 * text + TextWidth(label(entry), style) + 1.6 * text;
    if (x + width > image->width && x > text) x = text, y += line;
    const int row = static_cast<int>(y);
    if (image->height > top) {
      for (int j = row; j < std::min(row + square, image->height); ++j)
        for (int i = static_cast<int>(x); i < std::min(static_cast<int>(x) + square, image->width); ++i)
          std::copy(entry.color.begin(), entry.color.end(), image->at(i, j));
      DrawText(*image, x + square + 0.6 * text, row + 0.95 * square, label(entry), style);
    }
    x += width;
  }
  return static_cast<int>(y) + line - top;
}

}  // namespace

CertificateMap DrawCertificates(const SampleBuffer& samples) {
  // Colour each sample, and count the samples of each colour.
  CertificateMap map;
  std::vector<Entry> entries = {{kHit, "certified hits", 0}, {kMiss, "certified misses", 0}};
  for (std::size_t bit = 0; bit < kDoubtNames.size(); ++bit) {
    std::string name = kDoubtNames[bit];
    std::replace(name.begin(), name.end(), '_', ' ');
    entries.push_back({kDoubtColors[bit], name, 0});
  }
  std::vector<std::uint8_t> entry_of(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::uint8_t doubt = samples.doubt[i];
    const int entry = doubt ? 1 + std::bit_width(doubt) : samples.face[i] == kNoIndex;
    entry_of[i] = static_cast<std::uint8_t>(entry);
    ++entries[entry].count;
  }

  // Measure the legend, then draw both.
  std::vector<Entry> present;
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(present),
               [](const Entry& entry) { return entry.count > 0; });
  Image8& image = map.image;
  image.width = samples.width;
  const double text = std::clamp(samples.width / 48.0, 7.0, 28.0);
  map.legend_height = DrawLegend(&image, 0, text, present);
  image.height = samples.height + map.legend_height;
  image.bytes.resize(std::size_t(image.width) * image.height * 3);
  for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
    const Rgb& color = i < samples.size() ? entries[entry_of[i]].color : kBand;
    std::copy(color.begin(), color.end(), &image.bytes[3 * i]);
  }
  DrawLegend(&image, samples.height, text, present);
  return map;
}

}  // namespace facetless
