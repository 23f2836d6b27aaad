// How busy the machine is.
#pragma once

#include <cstdlib>

namespace facetless {

// Processes that ran or wanted to, on average over the last minute; 0 if the system does not tell.
inline double LoadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

}  // namespace facetless
