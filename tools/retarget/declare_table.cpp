#include "declare_table.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"

namespace retarget::cli {
namespace {

bool is_word(const Option& row) {
  return row.info.group.empty();
}

// Throws errors that the parser attributes to the option.
void set_value(const Option& row, const std::vector<std::string>& words) {
  const std::string flag = is_word(row) ? row.name : option_as_flag(row.name);
  OptionValue value = words;
  if (!row.is_list()) {
    auto read = option_value(row, words.back());
    if (!read) throw CLI::ValidationError(flag, read.error().message);
    value = std::move(*read);
  } else if (auto sound = check_option(row, value); !sound) {
    throw CLI::ValidationError(flag, sound.error().message);
  }
  if (auto set = row.set(value); !set) throw CLI::ValidationError(flag, set.error().message);
}

// The parser would read numbers as counts, and end on other words.
std::string check_flag_value(const std::string& text) {
  const bool known = text == "true" || text == "false";
  return known ? "" : "expected no value, true or false, found \"" + text + "\"";
}

// Returns the member's initial value, if it is a valid option value and the help text does not
// state a default.
std::string default_text(const Option& row) {
  const OptionValue value = row.get();
  const bool is_unset = row.is_list() || is_word(row) || !check_option(row, value) ||
                        row.info.help.find("default:") != std::string::npos;
  return is_unset ? std::string() : to_text(value);
}

void declare_row(CLI::App& command, const Option& row) {
  const std::string letter = row.info.letter.empty() ? "" : "-" + row.info.letter + ",";
  const std::string names = is_word(row) ? row.name : letter + option_as_flag(row.name);
  const std::string help = spell_options(row.info.help, option_as_flag);
  if (row.is_flag()) {
    command
        .add_flag_function(
            names, [row](std::int64_t count) { static_cast<void>(row.set(count > 0)); }, help)
        ->check(CLI::Validator(&check_flag_value, ""))
        ->group(row.info.group);
    return;
  }
  CLI::Option* declared = command.add_option(
      names,
      [row](const std::vector<std::string>& words) {
        set_value(row, words);
        return true;
      },
      help);
  declared
      ->type_name(row.info.type.empty() ? fmt::format("{}", fmt::join(row.choices, "|"))
                                        : row.info.type)
      ->required(row.info.required);
  if (!is_word(row)) declared->group(row.info.group);
  if (const std::string text = default_text(row); !text.empty()) declared->default_str(text);
  if (!row.is_list()) return;
  declared->type_size(1)
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->take_all()
      ->allow_extra_args(is_word(row));
  // Only lists use commas as delimiters; free text may contain them.
  if (row.info.type.ends_with(",...")) declared->delimiter(',');
}

}  // namespace

void declare(CLI::App& command, const OptionTable& rows) {
  for (const Option& row : rows) declare_row(command, row);
}

void refuse_empty_values(CLI::App& app) {
  const auto check = [](const std::string& text) -> std::string {
    return text.empty() ? "expected a value, found an empty string" : "";
  };
  for (CLI::Option* option : app.get_options()) {
    if (option->get_expected_max() > 0) option->check(CLI::Validator(check, ""));
  }
  for (CLI::App* command : app.get_subcommands({})) refuse_empty_values(*command);
}

}  // namespace retarget::cli
