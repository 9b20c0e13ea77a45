#pragma once

#include <string>
#include <string_view>

/// An option within the text of an error, a warning or a note, by its name in the schema of options:
/// `"give the rate with " OPTION("source-fps")`. The text has a mark there; whoever shows it writes the
/// option as its users know it (spell_options): `--source-fps`, `source_fps`.
// a macro, for texts are put together from literals before the program runs
#define OPTION(name) "\x0e" name "\x0f"

namespace retarget {

/// The same for an option that is known by its row.
inline std::string marked_option(std::string_view name) {
  constexpr std::string_view kMarks = OPTION("");
  return std::string(1, kMarks.front()).append(name) + kMarks.back();
}

}  // namespace retarget
