#pragma once

#include <utility>

#include "retarget/clip.h"

namespace retarget {

/// A clip whose length is no longer that of its file: its own memory determines how much a plan of
/// it may need.
[[nodiscard]] inline Clip without_file_size(Clip clip) {
  ClipOrigin origin = clip.origin();
  origin.bytes = 0;
  clip.set_origin(std::move(origin));
  return clip;
}

}  // namespace retarget
