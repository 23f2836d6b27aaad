#include "server/options/picture_options.h"

#include <utility>

#include "server/options/option_values.h"

namespace facetless {

Result<void> CheckPictureOptions(const PictureOptions& options, const std::string& command) {
  if (command == "render") return {};
  if (options.turntable > 0)
    return BadUsage("turntable is an option of render; " + command + " takes views one by one");
  if (command == "compare") return {};
  const std::pair<const char*, bool> given[] = {{"color", options.coloring.source != ColorSource::kFile},
                                                {"parts", !options.arrangement.parts.empty()},
                                                {"hide", !options.arrangement.hide.empty()},
                                                {"explode", options.arrangement.explode > 0},
                                                {"scale_bar", options.scale_bar},
                                                {"axes", options.axes},
                                                {"sheet", options.sheet}};
  for (const auto& [name, is] : given)
    if (is)
      return BadUsage(std::string(name) + " is an option of render and compare; " + command +
                      " takes models as they are");
  return {};
}

}  // namespace facetless
