#include "help_format.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "argument_tables.h"
#include "retarget/text.h"

namespace retarget::cli {
namespace {

// Column at which descriptions begin.
constexpr std::size_t kColumn = 30;

std::string description_lines(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return wrapped_text(text, 0, 0, kTextWidth - kColumn);
}

// Names of the options that the short help of a command omits unless they are required.
std::set<std::string> left_out_of_help(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  const bool is_part = parent != nullptr && parent->get_parent() != nullptr;
  return is_part ? shared_option_names() : advanced_option_names();
}

bool is_left_out(const CLI::Option& option, const std::set<std::string>& names) {
  return !option.get_required() && names.contains(option.get_single_name());
}

}  // namespace

bool only_help_all_lists(const CLI::App& command, const CLI::Option& option) {
  return is_left_out(option, left_out_of_help(command));
}

HelpFormat::HelpFormat() {
  column_width(kColumn);
}

std::string HelpFormat::make_help(const CLI::App* app, std::string name,
                                  CLI::AppFormatMode mode) const {
  const bool all = mode != CLI::AppFormatMode::Normal;
  return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) +
         (all ? make_groups(app, mode) : short_options(app)) + make_subcommands(app, mode) + "\n" +
         make_footer(app);
}

std::string HelpFormat::short_options(const CLI::App* app) const {
  std::vector<const CLI::Option*> needed, others;
  std::size_t hidden = 0;
  const std::set<std::string> left_out = left_out_of_help(*app);
  for (const CLI::Option* option : app->get_options()) {
    if (!option->nonpositional() || option->get_group().empty()) continue;
    if (is_left_out(*option, left_out)) {
      ++hidden;
    } else {
      (option->get_required() ? needed : others).push_back(option);
    }
  }
  needed.insert(needed.end(), others.begin(), others.end());
  std::string text = make_group("Options", false, needed);
  if (hidden > 0) {
    text += "\n" + std::to_string(hidden) + " more options: --help-all\n";
  }
  return text;
}

std::string HelpFormat::make_subcommands(const CLI::App* app, CLI::AppFormatMode) const {
  return CLI::Formatter::make_subcommands(app, CLI::AppFormatMode::Normal);
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
