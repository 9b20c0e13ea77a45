#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "console.h"

namespace retarget::cli {

/// The kind of output to generate, and the robot of a pack.
struct Generated {
  std::string what, robot;
};

/// Declares `retarget generate bash|zsh|fish|man|options`: completion scripts, the man page and
/// docs/options.md, generated from the declarations of all commands; and `retarget generate
/// robot-pack ROBOT`, the models of a robot for the browser page.
CLI::App* add_generate_command(CLI::App& app, Generated& generated);

/// Prints what was requested.
[[nodiscard]] ExitCode print_generated(const CLI::App& app, const Generated& generated);

}  // namespace retarget::cli
