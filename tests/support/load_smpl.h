#pragma once

#include <string>

#include "base/try.h"
#include "formats/smpl/read_smpl.h"
#include "retarget/file.h"

namespace retarget {

/// Reads a file with read_smpl.
inline Result<SmplMotion> load_smpl(const std::string& path) {
  TRY_ASSIGN(const auto bytes, read_file(path));
  return read_smpl(bytes.view(), path);
}

}  // namespace retarget
