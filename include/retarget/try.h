#pragma once

#include <utility>

#include "retarget/error.h"

// Macros that unwrap a Result<T> and return its error to the caller, which must return a Result
// too:
//
//   RETARGET_TRY(check(options));
//   RETARGET_TRY_ASSIGN(const auto clip, load_clip(file));
//
// They are macros because a function cannot return from its caller. No other public header
// includes this one.

/// Returns the error of a Result if it has one; discards a value.
#define RETARGET_TRY(...)                                        \
  do {                                                           \
    if (auto try_result = (__VA_ARGS__); !try_result) {          \
      return ::retarget::failure(std::move(try_result).error()); \
    }                                                            \
  } while (false)

/// Assigns the value of a Result to `target`, which may be a declaration; returns an error if it
/// has one.
#define RETARGET_TRY_ASSIGN(target, ...) \
  RETARGET_TRY_ASSIGN_TO(RETARGET_TRY_NAME(try_result_, __LINE__), target, __VA_ARGS__)

#define RETARGET_TRY_ASSIGN_TO(result, target, ...)                   \
  auto&& result = (__VA_ARGS__);                                      \
  if (!result) return ::retarget::failure(std::move(result).error()); \
  target = *std::move(result)
#define RETARGET_TRY_NAME(prefix, line) RETARGET_TRY_JOIN(prefix, line)
#define RETARGET_TRY_JOIN(prefix, line) prefix##line
