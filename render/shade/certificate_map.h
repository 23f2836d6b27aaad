// A picture of the certificates of a view. It shows which samples are proven, and why the others are not.
//
//  1. Certified hits are light grey, and certified misses are white. Every other sample, hit or miss, has the
//     colour of its most serious doubt, which is the highest bit of render/view/doubt.h.
//  2. A legend below the view names the colours and the number of samples of each. Doubts that do not occur
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
