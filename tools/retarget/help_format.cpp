#include "help_format.h"

#include <algorithm>
#include <sstream>

#include "base/wrapped_text.h"

namespace retarget::cli {
namespace {

// where descriptions begin
constexpr std::size_t kColumn = 30;

std::string description_lines(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return wrapped_text(text, 0, 0, kTextWidth - kColumn);
}

}  // namespace

HelpFormat::HelpFormat() {
  column_width(kColumn);
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return description_lines(CLI::Formatter::make_option_desc(option));
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  std::stringstream out;
  CLI::detail::format_help(out, command->get_name(), description_lines(command->get_description()),
                           kColumn);
  return out.str();
}

}  // namespace retarget::cli
