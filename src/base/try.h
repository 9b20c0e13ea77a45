#pragma once

#include <utility>

#include "retarget/error.h"

// Values of Result<T> are taken, errors passed on to the caller, which returns a Result as well:
//
//   TRY(check(options));
//   TRY_ASSIGN(const auto clip, read_bvh(bytes));
//
// Macros, for nothing else can return from the function that they stand in.

/// Returns the error of a Result, if it has one; a value is dropped.
#define TRY(...)                                                 \
  do {                                                           \
    if (auto try_result = (__VA_ARGS__); !try_result) {          \
      return ::retarget::failure(std::move(try_result).error()); \
    }                                                            \
  } while (false)

/// Declares, or assigns to, `target` with the value of a Result; returns the error if it has one.
#define TRY_ASSIGN(target, ...) \
  RETARGET_TRY_ASSIGN(RETARGET_TRY_NAME(try_result_, __LINE__), target, __VA_ARGS__)

#define RETARGET_TRY_ASSIGN(result, target, ...)                      \
  auto&& result = (__VA_ARGS__);                                      \
  if (!result) return ::retarget::failure(std::move(result).error()); \
  target = *std::move(result)
#define RETARGET_TRY_NAME(prefix, line) RETARGET_TRY_JOIN(prefix, line)
#define RETARGET_TRY_JOIN(prefix, line) prefix##line
