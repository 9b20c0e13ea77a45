#pragma once

#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// The options of a fit: those given, over them their file, the window, terms that are left out, and
/// as many digits as are written. Errors: of the file (kConfig), unknown terms (kUsage).
[[nodiscard]] Result<FitOptions> choose_fit(const Options& options);

}  // namespace retarget
