// The colour of each sample, and a legend that counts them.
#include "render/shade/certificate_map.h"

#include <gtest/gtest.h>

#include <set>

#include "render/view/doubt.h"

namespace facetless {
namespace {

SampleBuffer OneOfEach() {
  SampleBuffer samples;
  samples.Resize(400, 4);
  samples.doubt.assign(samples.size(), 0);
  for (std::size_t bit = 0; bit < kDoubtNames.size(); ++bit) samples.doubt[bit] = std::uint8_t(1u << bit);
  samples.face[samples.width] = 0;
  return samples;
}

std::array<int, 3> ColorAt(const Image8& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return {p[0], p[1], p[2]};
}

TEST(CertificateMap, HitsMissesAndEachDoubtHaveColoursOfTheirOwn) {
  const CertificateMap map = DrawCertificates(OneOfEach());
  std::set<std::array<int, 3>> colors = {ColorAt(map.image, 0, 1), ColorAt(map.image, 1, 1)};
  for (int x = 0; x < static_cast<int>(kDoubtNames.size()); ++x) colors.insert(ColorAt(map.image, x, 0));
  EXPECT_EQ(colors.size(), kDoubtNames.size() + 2);
}

TEST(CertificateMap, TheGravestDoubtDecides) {
  SampleBuffer samples = OneOfEach();
  samples.doubt[10] = kDoubtSilhouette | kDoubtContradicted;
  const CertificateMap map = DrawCertificates(samples);
  EXPECT_EQ(ColorAt(map.image, 10, 0), ColorAt(map.image, static_cast<int>(kDoubtNames.size()) - 1, 0));
}

TEST(CertificateMap, TheLegendStandsBelowAndGrowsWithItsEntries) {
  const CertificateMap all = DrawCertificates(OneOfEach());
  SampleBuffer plain = OneOfEach();
  plain.doubt.assign(plain.size(), 0);
  const CertificateMap few = DrawCertificates(plain);
  EXPECT_EQ(all.image.height, 4 + all.legend_height);
  EXPECT_GT(few.legend_height, 0);
  EXPECT_GT(all.legend_height, few.legend_height);
}

}  // namespace
}  // namespace facetless
