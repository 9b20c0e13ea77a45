#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/try.h"
#include "options/enum_names.h"
#include "retarget/error.h"

namespace retarget {

/// A value of any option: of a flag, of whole and other numbers, of texts and choices, of lists.
using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// What a file that an option names has to do with a motion.
enum class OptionFile : unsigned char {
  kNone,     ///< It names none, or one that is written.
  kContent,  ///< Its content decides the motion, whatever its name.
  kOrName,   ///< The same, but the option may hold a name (of a set, a kind) in place of a file.
};

/// What a row of a table says of an option beside its name and its member.
struct OptionInfo {
  std::string type =
      {};  ///< What stands for its value in help: `FILE`, `N|source`; empty: choices.
  std::string group = {};  ///< Of the help text; none: a word that is given without a name.
  std::string help = {};   ///< For people, one sentence or two, no full stop.
  double min = std::numeric_limits<double>::lowest();  ///< Of numbers.
  double max = std::numeric_limits<double>::max();
  bool decides = true;  ///< Whether the bytes of a motion depend on it.
  OptionFile file = OptionFile::kNone;
  bool basic = false;            ///< Stands in the short help.
  std::string letter = {};       ///< Short name at the command line; may be empty.
  std::string former_name = {};  ///< Read in files as well; empty: it always had its name.
  bool required = false;         ///< At the command line.
  std::string none = {};         ///< Of an optional enum: the word for no choice; empty: no word.
};

/// An option that is bound to a member of a struct: one row of a table. Everything that is told,
/// read or written of options is made from such rows (command line, JSON, records of runs, docs).
struct Option {
  std::string name;  ///< At the command line and in JSON: `source-fps`.
  OptionInfo info;
  std::vector<std::string> choices;  ///< Values that it may have; empty: any.
  bool is_optional = false;          ///< An empty text means no choice.
  std::function<OptionValue()> get;
  /// Takes a value that check_option let pass.
  std::function<Result<void>(const OptionValue&)> set;

  [[nodiscard]] bool is_flag() const { return std::holds_alternative<bool>(get()); }
  [[nodiscard]] bool is_list() const {
    return std::holds_alternative<std::vector<std::string>>(get());
  }
};

using OptionTable = std::vector<Option>;

/// A member of an own type that options write as text.
template <typename T>
Option text_option(std::string name, T& member, std::string group, std::string type,
                   std::string help, std::string (*to_text)(const T&),
                   Result<T> (*from_text)(const std::string&), OptionInfo info = {}) {
  info.group = std::move(group);
  info.type = std::move(type);
  info.help = std::move(help);
  return {std::move(name),
          std::move(info),
          {},
          false,
          [&member, to_text] { return OptionValue(to_text(member)); },
          [&member, from_text](const OptionValue& value) -> Result<void> {
            TRY_ASSIGN(member, from_text(std::get<std::string>(value)));
            return {};
          }};
}

/// The row of a member: a bool, a number or an optional one, a text, a list of texts, an enum with
/// named values, or a list or an optional of one. The member must outlive the row.
template <typename T>
Option option(std::string name, T& member, OptionInfo info) {
  Option row{std::move(name), std::move(info), {}, false, {}, {}};
  if constexpr (Named<T>) {
    row.choices = enum_names<T>();
    row.get = [&member] { return OptionValue(std::string(enum_name(member))); };
    row.set = [&member](const OptionValue& value) -> Result<void> {
      member = *enum_from_name<T>(std::get<std::string>(value));
      return {};
    };
  } else if constexpr (requires { requires Named<typename T::value_type>; }) {
    using Enum = typename T::value_type;
    row.choices = enum_names<Enum>();
    if constexpr (std::is_same_v<T, std::optional<Enum>>) {
      const std::string none = row.info.none;
      row.is_optional = none.empty();
      if (!none.empty()) row.choices.insert(row.choices.begin(), none);
      row.get = [&member, none] {
        return OptionValue(member ? std::string(enum_name(*member)) : none);
      };
      row.set = [&member](const OptionValue& value) -> Result<void> {
        member = enum_from_name<Enum>(std::get<std::string>(value));
        return {};
      };
    } else {
      row.get = [&member] {
        std::vector<std::string> names;
        names.reserve(member.size());
        for (const Enum each : member) names.emplace_back(enum_name(each));
        return OptionValue(std::move(names));
      };
      row.set = [&member](const OptionValue& value) -> Result<void> {
        member.clear();
        for (const std::string& each : std::get<std::vector<std::string>>(value)) {
          member.push_back(*enum_from_name<Enum>(each));
        }
        return {};
      };
    }
  } else if constexpr (std::is_same_v<T, std::optional<double>>) {
    // no choice is a number that no range holds
    row.get = [&member] {
      return OptionValue(member.value_or(std::numeric_limits<double>::quiet_NaN()));
    };
    row.set = [&member](const OptionValue& value) -> Result<void> {
      member = std::get<double>(value);
      return {};
    };
  } else {
    using Value = std::conditional_t<std::is_same_v<T, int>, std::int64_t, T>;
    row.get = [&member] { return OptionValue(static_cast<Value>(member)); };
    row.set = [&member](const OptionValue& value) -> Result<void> {
      member = static_cast<T>(std::get<Value>(value));
      return {};
    };
  }
  return row;
}

/// The same: what stands for its value (empty: its choices), its help, and what else there is to say.
template <typename T>
Option option(std::string name, T& member, std::string group, std::string type, std::string help,
              OptionInfo info = {}) {
  info.group = std::move(group);
  info.type = std::move(type);
  info.help = std::move(help);
  return option(std::move(name), member, std::move(info));
}

/// What an option may be: `a number from 0.1 to 1000000`, `true or false`, `one of fit, gmr`.
[[nodiscard]] std::string expectation(const Option& row);

/// Whether an option may have a value: its kind, its range, its choices. Errors (kUsage) say what
/// was expected and what was found, and do not name the option.
[[nodiscard]] Result<void> check_option(const Option& row, const OptionValue& value);

/// A value as it is written: shortest numbers, `true` and `false`, lists parted by commas.
[[nodiscard]] std::string to_text(const OptionValue& value);

/// The value that a text means for an option. Errors as check_option's.
[[nodiscard]] Result<OptionValue> option_value(const Option& row, const std::string& text);

/// By name; null: there is none.
[[nodiscard]] const Option* find_option(const OptionTable& table, std::string_view name);
[[nodiscard]] std::vector<std::string> option_names(const OptionTable& table);

/// Moves the rows of one table behind those of another.
void append(OptionTable& table, OptionTable rows);

}  // namespace retarget
