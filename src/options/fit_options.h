#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "options/option_table.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// The rows of FitOptions; names are those of its members, of the terms with hyphens.
[[nodiscard]] OptionTable fit_table(FitOptions& options);

/// Reads options from JSON: an object with names of fit_table; what is left out keeps its value.
/// Unknown names, wrong types and values out of range are named all at once (kConfig), with the
/// nearest name.
/// @param file  for messages.
[[nodiscard]] Result<FitOptions> parse_fit_options(std::string_view text, const std::string& file,
                                                   FitOptions options = {});

/// Names of the terms that can be left out or added.
[[nodiscard]] const std::vector<std::string>& fit_term_names();

/// Takes terms in or leaves them out by name; a kUsage error suggests the nearest name.
[[nodiscard]] Result<void> set_terms(FitOptions& options, std::span<const std::string> names,
                                     bool on);

}  // namespace retarget
