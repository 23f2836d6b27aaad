// The certificates of a view as a picture: which samples are proven, and why the others are not.
//
//  1. Certified hits are light grey, certified misses white; every other sample has the colour of its gravest
//     doubt, the last of render/view/doubt.h, hit or not.
//  2. A band below the view names the colours with the number of samples of each; doubts that do not occur
//     are left out.
#pragma once

#include "render/image/film.h"
#include "render/view/samples.h"

namespace facetless {

struct CertificateMap {
  Image8 image;           // RGB
  int legend_height = 0;  // pixel rows below the view
};

// Requires samples with certificates and doubts.
CertificateMap DrawCertificates(const SampleBuffer& samples);

}  // namespace facetless
