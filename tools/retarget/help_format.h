#pragma once

#include <CLI/CLI.hpp>

#include <set>
#include <string>

namespace retarget::cli {

/// CLI11's help, broken to fit a terminal. `--help` shows what most calls need; `--help-all` all
/// options of the command.
class HelpFormat : public CLI::Formatter {
 public:
  /// @param advanced  names of the options that --help leaves out,
  /// @param shared    and of those for parts of a command.
  HelpFormat(std::set<std::string> advanced, std::set<std::string> shared);
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* command) const override;
  [[nodiscard]] std::string make_help(const CLI::App* app, std::string name,
                                      CLI::AppFormatMode mode) const override;
  [[nodiscard]] std::string make_subcommands(const CLI::App* app,
                                             CLI::AppFormatMode mode) const override;

 private:
  [[nodiscard]] std::string short_options(const CLI::App* app) const;

  std::set<std::string> advanced_, shared_;
};

}  // namespace retarget::cli
