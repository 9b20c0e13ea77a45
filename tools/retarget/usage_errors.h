#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget::cli {

/// What a command needs and a command line lacks.
struct Need {
  std::string what;  ///< `robot`
  std::string how;   ///< `--robot NAME`
};

/// One kUsage error for all that is lacking; nothing: all is there.
/// @param help  what else to say: where the command's help is.
[[nodiscard]] Result<void> check_needs(const std::vector<Need>& needs, const std::string& help);

/// `retarget help edit path` as `retarget edit path --help`.
/// @param words  those behind the program's name.
[[nodiscard]] std::vector<std::string> without_help_command(std::vector<std::string> words);

/// Errors (kUsage): a word in the place of a command that is none. The first word may be a motion
/// file or a robot as well, so it must be nearly a command, unless help is asked for.
[[nodiscard]] Result<void> check_command(const CLI::App& app, const std::vector<std::string>& words,
                                         bool for_help);

/// Everything that the given command needs beside what each option checks, in one error (kUsage).
[[nodiscard]] Result<void> check_given(const CLI::App& app);

/// What a command line holds beyond options, with the option that may be meant.
[[nodiscard]] Failure unknown_words(const CLI::App& app);

/// What the parser found wrong.
[[nodiscard]] Failure wrong_words(const CLI::App& app, const CLI::ParseError& error);

}  // namespace retarget::cli
