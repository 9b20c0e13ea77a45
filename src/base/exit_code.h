#pragma once

#include "retarget/error.h"

namespace retarget {

/// Exit code of a process that ends with an error of this kind. The README lists the codes for
/// users.
[[nodiscard]] constexpr int exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return 2;
    case ErrorKind::kInput:
      return 3;
    case ErrorKind::kConfig:
      return 4;
    case ErrorKind::kInterrupted:
      return 130;
    case ErrorKind::kRun:
      break;
  }
  return 1;
}

}  // namespace retarget
