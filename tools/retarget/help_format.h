#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace retarget::cli {

/// CLI11's help with descriptions that are broken to fit a terminal.
class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat();
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace retarget::cli
