#include "app/options/options_json.h"

#include <fmt/format.h>
#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Converts a JSON value to the type of an option; nothing for a value of another type.
std::optional<OptionValue> value_of(const Json& json, const OptionValue& kind) {
  if (std::holds_alternative<bool>(kind)) {
    if (json.is_boolean()) return json.get<bool>();
  } else if (std::holds_alternative<std::int64_t>(kind)) {
    // Larger numbers would overflow to negative ones.
    const bool fits = json.is_number_unsigned() ? json.get<std::uint64_t>() >> 62U == 0
                                                : json.is_number_integer();
    if (fits) return json.get<std::int64_t>();
    // Accept 6.0, which other writers produce for integers.
    if (json.is_number_float() && std::nearbyint(json.get<double>()) == json.get<double>() &&
        std::abs(json.get<double>()) < 1e15) {
      return static_cast<std::int64_t>(json.get<double>());
    }
  } else if (std::holds_alternative<double>(kind)) {
    if (json.is_number()) return json.get<double>();
  } else if (std::holds_alternative<std::string>(kind)) {
    if (json.is_string()) return json.get<std::string>();
  } else if (json.is_array()) {
    std::vector<std::string> words;
    for (const Json& each : json) {
      if (!each.is_string()) return std::nullopt;
      words.push_back(each.get<std::string>());
    }
    return words;
  }
  return std::nullopt;
}

}  // namespace

Json options_json(const OptionTable& table) {
  Json json = Json::object();
  for (const Option& row : table) {
    if (!is_recorded(row)) continue;
    const OptionValue value = row.get();
    if (const auto* text = std::get_if<std::string>(&value)) {
      put_name(json, row.name, *text);
    } else {
      std::visit([&](const auto& plain) { json[row.name] = plain; }, value);
    }
  }
  return json;
}

Result<void> read_options(const Json& json, const OptionTable& table, const std::string& file,
                          const std::string& what) {
  if (!json.is_object()) {
    return config_failure(file, what + " must be an object, found " + short_text(json));
  }
  Faults faults;
  for (const auto& [name, given] : json.items()) {
    // The raw bytes of a text that is not valid UTF-8; name_from reads them.
    const bool is_hex = name.ends_with(kHexKeyEnd) && given.is_string() &&
                        find_option(table, name.substr(0, name.size() - kHexKeyEnd.size()));
    if (is_hex) continue;
    const Option* row = find_option(table, name);
    if (row == nullptr) {
      faults.add(fmt::format("unknown option \"{}\"{}", name,
                             faults.suggestion(name, option_names(table))));
      continue;
    }
    auto value = value_of(given, row->get());
    if (value && std::holds_alternative<std::string>(*value)) value = name_from(json, name);
    // A value that stands for "not given" may be out of range.
    if (value && *value == row->get()) continue;
    if (!value || !check_option(*row, *value)) {
      faults.add(
          fmt::format("\"{}\" must be {}, found {}", name, expectation(*row), short_text(given)));
    } else if (auto set = row->set(*value); !set) {
      faults.add(fmt::format("\"{}\": {}", name, set.error().message));
    }
  }
  if (faults.empty()) return {};
  return faults.failure_in(file, what);
}

std::string options_text(const OptionTable& table) {
  return printable_dump(options_json(table));
}

Result<void> load_options(const std::string& file, const OptionTable& table,
                          const std::string& what) {
  TRY_ASSIGN(const Json json, load_json(file));
  return read_options(json, table, file, what);
}

}  // namespace retarget
