#pragma once

#include "arguments.h"
#include "console.h"
#include "edit_arguments.h"

namespace retarget::cli {

/// Each command does its work and gives the exit code of the process.
[[nodiscard]] ExitCode run(const RunArguments& arguments, Console& console);
[[nodiscard]] ExitCode batch(const BatchArguments& arguments, Console& console);
[[nodiscard]] ExitCode inspect(const InspectArguments& arguments, Console& console);
[[nodiscard]] ExitCode edit(const EditArguments& arguments, Console& console);
[[nodiscard]] ExitCode evaluate(const EvaluateArguments& arguments, Console& console);
[[nodiscard]] ExitCode convert(const ConvertArguments& arguments, Console& console);
[[nodiscard]] ExitCode compare(const CompareArguments& arguments, Console& console);
[[nodiscard]] ExitCode verify(const VerifyArguments& arguments, Console& console);
[[nodiscard]] ExitCode view(const ViewArguments& arguments, Console& console);
[[nodiscard]] ExitCode robots(const RobotsArguments& arguments, Console& console);

}  // namespace retarget::cli
