#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "base/try.h"
#include "formats/smpl/read_smpl.h"
#include "retarget/file.h"

namespace retarget {

/// Reads an SMPL motion with read_array_motion.
inline Result<SmplMotion> read_smpl(std::string_view bytes, const std::string& file_name,
                                    const ArrayReadOptions& options = {}) {
  TRY_ASSIGN(auto motion, read_array_motion(bytes, file_name, options));
  if (auto* smpl = std::get_if<SmplMotion>(&motion)) return std::move(*smpl);
  return input_failure(file_name, "expected an SMPL motion, found joint positions");
}

/// Reads a file with read_smpl.
inline Result<SmplMotion> load_smpl(const std::string& path) {
  TRY_ASSIGN(const auto bytes, read_file(path));
  return read_smpl(bytes.view(), path);
}

}  // namespace retarget
