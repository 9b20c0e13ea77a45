#include "live/stream/controller_outputs.h"

#include <fmt/format.h>

namespace retarget {

Failure lacks_library(const StreamAddress& to, std::string_view library, std::string_view package) {
  return usage_failure(fmt::format("this build lacks {}; {} needs it", library, to.text()),
                       fmt::format("install {} and rebuild (docs/building.md)", package));
}

}  // namespace retarget
