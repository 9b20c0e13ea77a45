#pragma once

#include <stdexcept>
#include <utility>

#include "retarget/error.h"

namespace retarget {

/// The value of a result. An error ends the test with its description.
template <typename T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(describe(result.error()));
  return *std::move(result);
}

}  // namespace retarget
