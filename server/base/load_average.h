// The load of the machine.
#pragma once

#include <cstdlib>

namespace facetless {

// The number of running and runnable processes, averaged over the last minute; 0 if the system does not
// report it.
inline double LoadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

}  // namespace facetless
