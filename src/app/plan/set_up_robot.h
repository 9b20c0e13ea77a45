#pragma once

#include <string>

#include "retarget/options.h"

namespace retarget {

/// Sets the options of the fit that a preset (SolveOptions::purpose) chooses. Options that
/// SolveOptions::fit changes are kept. The options file and terms given by name are applied
/// afterwards and take precedence.
void apply_preset(const SolveOptions& options, FitOptions& fit);

/// The travel that is given or that the preset chooses; empty: none.
[[nodiscard]] std::string chosen_travel(const SolveOptions& options);

}  // namespace retarget
