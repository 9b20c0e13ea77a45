#pragma once

#include <string>
#include <vector>

#include "options/option_table.h"
#include "retarget/error.h"
#include "retarget/report.h"

namespace retarget {

/// The gates of configs/quality/default.json.
[[nodiscard]] Result<Gates> default_gates(const std::string& data_folder);

/// The default gates as a user changes them, one text after the other: a file of gates,
/// `FIGURE<=MAX`, `FIGURE>=MIN`, `FIGURE=MAX`, `FIGURE=none`, `none` for no gates at all, `default` for
/// those that there are. The first text on a figure replaces its gate; `<=` and `>=` on the same figure
/// make one gate together. A figure's name may lack what stands behind its last `_`: `limb_angle`.
/// Errors: unknown figures and what is no number (kUsage), what is wrong in a file (kConfig).
[[nodiscard]] Result<Gates> changed_gates(const std::vector<std::string>& texts,
                                          const std::string& data_folder);

/// What a text may be, for the help of commands that need it in full.
inline constexpr const char* kGateHelp =
    "Gates beyond configs/quality/default.json, or instead: a file like it, 'FIGURE<=MAX', "
    "'FIGURE>=MIN' (in quotes), FIGURE=MAX, FIGURE=none, or none for no gates at all; repeatable";

/// The option whose texts these are.
[[nodiscard]] Option gate_row(std::vector<std::string>& texts, const std::string& help = kGateHelp);

}  // namespace retarget
