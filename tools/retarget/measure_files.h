#pragma once

#include <string>
#include <vector>

#include "arguments.h"
#include "retarget/error.h"
#include "retarget/measure_files.h"

namespace retarget::cli {

/// Checks motions and source for errors that do not depend on the command: an option that needs a
/// source without one, standard input given twice.
/// @return all files that will be read.
[[nodiscard]] Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments);

/// The measurement that the arguments describe. Errors (kUsage): two sources.
[[nodiscard]] Result<MeasureRequest> measure_request(const MeasureArguments& arguments);

}  // namespace retarget::cli
