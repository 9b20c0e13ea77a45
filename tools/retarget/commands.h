#pragma once

#include "arguments.h"
#include "console.h"
#include "edit_arguments.h"
#include "retarget/error.h"

namespace retarget::cli {

/// Runs a command. Commands that return an ExitCode report their result through it; otherwise the
/// process exits with the error's code, or kDone.
[[nodiscard]] Result<ExitCode> run(const RunArguments& arguments, Console& console);
[[nodiscard]] Result<ExitCode> batch(const BatchArguments& arguments, Console& console);
[[nodiscard]] Result<void> inspect(const InspectArguments& arguments, Console& console);
[[nodiscard]] Result<void> contacts(const ContactsArguments& arguments, Console& console);
[[nodiscard]] Result<void> find_scene(const SceneFromMotionArguments& arguments, Console& console);
[[nodiscard]] Result<void> edit(const EditArguments& arguments, Console& console);
[[nodiscard]] Result<ExitCode> evaluate(const EvaluateArguments& arguments, Console& console);
[[nodiscard]] Result<void> convert(const ConvertArguments& arguments, Console& console);
[[nodiscard]] Result<void> compare(const CompareArguments& arguments, Console& console);
[[nodiscard]] Result<ExitCode> certify(const CertifyArguments& arguments, Console& console);
[[nodiscard]] Result<ExitCode> simulate(const SimulateArguments& arguments, Console& console);
[[nodiscard]] Result<void> verify(const VerifyArguments& arguments, Console& console);
[[nodiscard]] Result<void> live(const LiveArguments& arguments, Console& console);
[[nodiscard]] Result<void> view(const ViewArguments& arguments, Console& console);
/// The part of `view` that makes pages of all motions of a batch, and an index page.
[[nodiscard]] Result<void> view_gallery(const ViewArguments& arguments, Console& console);
[[nodiscard]] Result<ExitCode> robots(const RobotsArguments& arguments, Console& console);

}  // namespace retarget::cli
