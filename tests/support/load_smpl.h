#pragma once

#include <string>

#include "base/file.h"
#include "base/try.h"
#include "smpl/read_smpl.h"

namespace retarget {

/// read_smpl of a file.
inline Result<SmplMotion> load_smpl(const std::string& path) {
  TRY_ASSIGN(const auto bytes, read_file(path));
  return read_smpl(bytes.view(), path);
}

}  // namespace retarget
