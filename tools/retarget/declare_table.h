#pragma once

#include <CLI/CLI.hpp>

#include "retarget/option_table.h"

namespace retarget::cli {

/// Declares the rows of a table as options of a command. The bound structs must outlive parsing.
void declare(CLI::App& command, const OptionTable& rows);

/// Returns the row of a positional argument.
template <typename T>
Option word(const char* name, T& member, const char* type, const char* help, bool required = true) {
  return option(name, member, {.type = type, .help = help, .required = required});
}

/// Largest time that an option accepts, seconds; longer than any motion, but catches typing errors.
inline constexpr double kMaxTime = 1e9;

/// Makes an empty argument an error in all options of a command and its subcommands: an unset shell
/// variable must not look like an omitted option.
void refuse_empty_values(CLI::App& app);

}  // namespace retarget::cli
