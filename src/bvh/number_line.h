#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace retarget {

/// How far beyond its count of values a row must have room: fast readers check only now and then.
inline constexpr std::size_t kNumberLineSlack = 32;

/// Reads a line that holds nothing but numbers and blanks between them.
///
/// Values are bit for bit those of parse_number. Readers may decline any line: what they decline
/// is then read number by number, where its faults are found too.
/// @param text   the whole text.
/// @param begin  byte offset of the line's first value.
/// @param row    room for `count` values and kNumberLineSlack more, which may be overwritten.
/// @return byte offset of the line's end (its CR or LF, or the end of the text); npos when the
///     line is declined or does not hold exactly `count` numbers.
using ReadNumberLine = std::size_t (*)(std::string_view text, std::size_t begin, std::size_t count,
                                       std::span<double> row);

/// For any machine.
[[nodiscard]] std::size_t read_number_line_portable(std::string_view text, std::size_t begin,
                                                    std::size_t count, std::span<double> row);

/// The reader in vector instructions for this processor; nullptr where there is none.
[[nodiscard]] ReadNumberLine vector_number_line_reader();

/// The fastest reader for this processor.
[[nodiscard]] ReadNumberLine fastest_number_line_reader();

}  // namespace retarget
