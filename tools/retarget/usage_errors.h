#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget::cli {

/// A required argument that is missing from a command line.
struct Need {
  std::string what;  ///< `robot`
  std::string how;   ///< `--robot NAME`
};

/// Reports all missing arguments in one kUsage error; succeeds if there are none.
/// @param help  appended hint on where to find help.
[[nodiscard]] Result<void> check_needs(const std::vector<Need>& needs, const std::string& help);

/// Rewrites `retarget help edit path` as `retarget edit path --help`.
/// @param words  arguments after the program's name.
[[nodiscard]] std::vector<std::string> without_help_command(std::vector<std::string> words);

/// Errors (kUsage): a word in place of a command that is not a command. The first word may also be
///   a motion file or a robot, so it must resemble a command, unless help is requested.
[[nodiscard]] Result<void> check_command(const CLI::App& app, const std::vector<std::string>& words,
                                         bool for_help);

/// Checks requirements of the given command beyond single options; reports them in one kUsage
/// error.
[[nodiscard]] Result<void> check_given(const CLI::App& app);

/// Returns the error for unexpected words on a command line, with the probable option.
[[nodiscard]] Failure unknown_words(const CLI::App& app);

/// Returns the error for a parser exception.
[[nodiscard]] Failure wrong_words(const CLI::App& app, const CLI::ParseError& error);

}  // namespace retarget::cli
