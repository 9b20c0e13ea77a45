#pragma once

#include "arguments.h"
#include "console.h"
#include "edit_options.h"
#include "options.h"
#include "view_options.h"

namespace retarget::cli {

/// Each command does its work and gives the exit code of the process.
[[nodiscard]] ExitCode run(const RunArguments& arguments, Console& console);
[[nodiscard]] ExitCode batch(const BatchArguments& arguments, Console& console);
[[nodiscard]] ExitCode inspect(const InspectOptions& options, Console& console);
[[nodiscard]] ExitCode edit(const EditOptions& options, Console& console);
[[nodiscard]] ExitCode evaluate(const EvaluateArguments& arguments, Console& console);
[[nodiscard]] ExitCode convert(const ConvertOptions& options, Console& console);
[[nodiscard]] ExitCode compare(const CompareOptions& options, Console& console);
[[nodiscard]] ExitCode verify(const VerifyArguments& arguments, Console& console);
[[nodiscard]] ExitCode view(const ViewOptions& options, Console& console);
[[nodiscard]] ExitCode robots(const RobotsOptions& options, Console& console);

}  // namespace retarget::cli
