#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "console.h"

namespace retarget::cli {

/// Declares `retarget generate bash|zsh|fish|man|options`: completion scripts, the man page and
/// docs/options.md, generated from the declarations of all commands.
CLI::App* add_generate_command(CLI::App& app, std::string& what);

/// Prints the requested text.
[[nodiscard]] ExitCode print_generated(const CLI::App& app, const std::string& what);

}  // namespace retarget::cli
