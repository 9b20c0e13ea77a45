#pragma once

#include <cstddef>
#include <string_view>

#include "bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

/// Whether a token is, or begins with, a way to write NaN or infinity.
[[nodiscard]] bool is_nan_or_infinity(std::string_view token);

/// The error for a token that is not a number: says which of the usual faults it is (decimal
/// comma, NaN, a missing blank, a value out of range, a NUL byte), with a hint.
/// @param role  what the number is, as `value 4 of 57 in row 2`.
[[nodiscard]] Failure number_failure(const SourceText& source, std::size_t offset,
                                     std::string_view role);

}  // namespace retarget
