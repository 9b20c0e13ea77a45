#pragma once

#include <string>
#include <string_view>

#include "retarget/export.h"

/// Marks an option name in the text of an error, warning or note: `"give the rate with "
/// RETARGET_OPTION("source-fps")`. `name` is the name in the option schema. The front end replaces
/// the mark with its own spelling (spell_options): `--source-fps` or `source_fps`.
// A macro, because the text is concatenated from literals at compile time. No other public header
// includes this one.
#define RETARGET_OPTION(name) "\x0e" name "\x0f"

namespace RETARGET_API retarget {

/// Marks an option whose name is known only at run time.
inline std::string marked_option(std::string_view name) {
  constexpr std::string_view kMarks = RETARGET_OPTION("");
  return std::string(1, kMarks.front()).append(name) + kMarks.back();
}

}  // namespace retarget
