// The recorded clips of the folder data.
#pragma once

#include <string>

#include "formats/bvh/read_bvh.h"
#include "retarget/clip.h"

namespace retarget {

inline Clip recorded_clip(const std::string& name) {
  return load_bvh(std::string(RETARGET_SOURCE_DIR) + "/data/" + name + ".bvh").value().clip;
}

}  // namespace retarget
