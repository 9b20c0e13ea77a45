#pragma once

#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Adds a file name to an input error that has none. For callers that know the input file when the
/// functions they call do not.
template <typename T>
[[nodiscard]] Result<T> located(Result<T> result, std::string_view file) {
  if (!result && result.error().kind == ErrorKind::kInput && result.error().location.file.empty()) {
    result.error().location.file = file;
  }
  return result;
}

}  // namespace retarget
