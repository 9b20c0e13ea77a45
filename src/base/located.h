#pragma once

#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// A result whose error, where it is one of the input and names no file, is about this one: for those
/// who know where the input came from, which what they call need not.
template <typename T>
[[nodiscard]] Result<T> located(Result<T> result, std::string_view file) {
  if (!result && result.error().kind == ErrorKind::kInput && result.error().location.file.empty()) {
    result.error().location.file = file;
  }
  return result;
}

}  // namespace retarget
