#include "retarget/option_table.h"

#include <fmt/format.h>
#include <algorithm>

#include "retarget/text.h"

namespace retarget {
namespace {

Failure unexpected(const Option& row, const OptionValue& found) {
  const auto* word = std::get_if<std::string>(&found);
  return usage_failure(fmt::format("expected {}, found \"{}\"{}", expectation(row), to_text(found),
                                   word ? did_you_mean(*word, row.choices) : std::string()));
}

bool is_for(OptionUse use, const Option& row) {
  return (static_cast<unsigned>(row.info.uses) & static_cast<unsigned>(use)) != 0;
}

}  // namespace

std::string expectation(const Option& row) {
  const OptionValue now = row.get();
  if (std::holds_alternative<bool>(now)) return "true or false";
  if (!row.choices.empty()) {
    return (row.is_list() ? "some of " : "one of ") + list_names(row.choices);
  }
  const bool is_count = std::holds_alternative<std::int64_t>(now);
  if (!is_count && !std::holds_alternative<double>(now)) return "a string";
  std::string text = is_count ? "a whole number" : "a number";
  const auto& [min, max] = std::pair(row.info.min, row.info.max);
  const bool above = max < std::numeric_limits<double>::max();
  if (above) return fmt::format("{} from {} to {}", text, min, max);
  if (min > std::numeric_limits<double>::lowest()) text += fmt::format(" of at least {}", min);
  return text;
}

Result<void> check_option(const Option& row, const OptionValue& value) {
  if (const auto* number = std::get_if<double>(&value)) {
    // False for NaN, too.
    const bool sound = *number >= row.info.min && *number <= row.info.max;
    if (!sound) return unexpected(row, value);
  } else if (const auto* count = std::get_if<std::int64_t>(&value)) {
    const double min = std::max(row.info.min, double{std::numeric_limits<int>::min()});
    const double max = std::min(row.info.max, double{std::numeric_limits<int>::max()});
    const auto size = static_cast<double>(*count);
    if (size < min || size > max) return unexpected(row, value);
  }
  if (row.choices.empty()) return {};
  const auto is_known = [&](const std::string& word) {
    return std::ranges::find(row.choices, word) != row.choices.end();
  };
  const auto* word = std::get_if<std::string>(&value);
  const bool is_none = row.is_optional && word != nullptr && word->empty();
  if (word != nullptr && !is_none && !is_known(*word)) return unexpected(row, value);
  if (const auto* words = std::get_if<std::vector<std::string>>(&value)) {
    for (const std::string& each : *words) {
      if (!is_known(each)) return unexpected(row, each);
    }
  }
  return {};
}

std::string to_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* count = std::get_if<std::int64_t>(&value)) return std::to_string(*count);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  std::string all;
  for (const std::string& word : std::get<std::vector<std::string>>(value)) {
    all += (all.empty() ? "" : ",") + word;
  }
  return all;
}

Result<OptionValue> option_value(const Option& row, const std::string& text) {
  const OptionValue now = row.get();
  std::optional<OptionValue> value;
  if (std::holds_alternative<bool>(now)) {
    if (text == "true" || text == "false") value = text == "true";
  } else if (std::holds_alternative<std::int64_t>(now)) {
    if (const auto count = parse_number<std::int64_t>(text)) value = *count;
  } else if (std::holds_alternative<double>(now)) {
    if (const auto number = parse_number<double>(text)) value = *number;
  } else if (std::holds_alternative<std::string>(now)) {
    value = text;
  } else {
    value = std::vector<std::string>{text};
  }
  if (!value) return unexpected(row, text);
  // Report the value as it was written.
  if (!check_option(row, *value)) return unexpected(row, text);
  return *value;
}

const Option* find_option(const OptionTable& table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &Option::name);
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string> option_names(const OptionTable& table) {
  std::vector<std::string> names;
  names.reserve(table.size());
  for (const Option& row : table) names.push_back(row.name);
  return names;
}

void append(OptionTable& table, OptionTable rows) {
  std::ranges::move(rows, std::back_inserter(table));
}

bool is_recorded(const Option& row) {
  if (!row.info.decides) return false;
  return !row.info.recorded_if_given || !to_text(row.get()).empty();
}

OptionTable rows_for(OptionUse use, OptionTable table) {
  std::erase_if(table, [use](const Option& row) { return !is_for(use, row); });
  return table;
}

OptionTable rows_not_for(OptionUse use, OptionTable table) {
  std::erase_if(table, [use](const Option& row) { return is_for(use, row); });
  return table;
}

OptionTable without_rows_of(const OptionTable& taken, OptionTable table) {
  std::erase_if(table, [&](const Option& row) {
    return std::ranges::find(taken, row.name, &Option::name) != taken.end();
  });
  return table;
}

OptionTable without(OptionTable table, std::initializer_list<std::string_view> names) {
  std::erase_if(
      table, [&](const Option& row) { return std::ranges::find(names, row.name) != names.end(); });
  return table;
}

std::vector<std::string> changed_options(const OptionTable& table, const OptionTable& other) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table.size(); ++i) {
    // As texts, because the NaN that stands for "not given" differs from itself.
    if (to_text(table[i].get()) != to_text(other[i].get())) names.push_back(table[i].name);
  }
  return names;
}

}  // namespace retarget
