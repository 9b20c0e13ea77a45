#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace retarget::cli {

/// CLI11's help, wrapped to the terminal width. `--help` shows the common options, `--help-all` all
/// options of the command.
class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat();
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* command) const override;
  [[nodiscard]] std::string make_help(const CLI::App* app, std::string name,
                                      CLI::AppFormatMode mode) const override;
  [[nodiscard]] std::string make_subcommands(const CLI::App* app,
                                             CLI::AppFormatMode mode) const override;

 private:
  [[nodiscard]] std::string short_options(const CLI::App* app) const;
};

/// Whether `--help` of a command leaves this option to `--help-all`.
[[nodiscard]] bool only_help_all_lists(const CLI::App& command, const CLI::Option& option);

}  // namespace retarget::cli
