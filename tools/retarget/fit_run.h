#pragma once

#include "console.h"
#include "human_source.h"
#include "options.h"
#include "refine/fit.h"

namespace retarget::cli {

/// The options of a fit that the command line asks for, from their file and the rest.
[[nodiscard]] Result<FitOptions> fit_options(const RunOptions& options);

/// Retargets a clip with `--method fit` and prints what was found and what is left.
[[nodiscard]] Result<FitResult> run_fit(const Clip& clip, const HumanSource& human,
                                        const std::shared_ptr<const Robot>& robot,
                                        const ResolvedMapping& tables, const LimitSet& limits,
                                        const RunOptions& options,
                                        const RetargetOptions& first_stage, Console& console);

}  // namespace retarget::cli
