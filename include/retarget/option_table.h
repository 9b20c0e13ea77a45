#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "retarget/enum_names.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

/// Value of an option: flag, integer, number, string or choice, list.
using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// How a file named by an option affects a motion.
enum class OptionFile : unsigned char {
  kNone,     ///< The option names no file, or an output file.
  kContent,  ///< The content of the file affects the motion, its name does not.
  kOrName,   ///< Like kContent, but the value may also be a name (of a set, a kind) instead of a
             ///< file.
};

/// Commands other than a run that accept some of a run's options. Each row states its commands, so
/// that commands need no lists of names. Values combine with `|`.
enum class OptionUse : unsigned {
  kNone = 0,
  kMeasure = 1U << 0U,  ///< Measuring a robot motion against its source.
  kShow = 1U << 1U,     ///< Showing a robot motion next to its source.
  kShowBatch =
      1U << 2U,         ///< Showing a motion of a batch, from the options that the batch recorded.
  kConvert = 1U << 3U,  ///< Converting and comparing robot motions.
  kInspect = 1U << 4U,  ///< Describing a human motion.
  kEdit = 1U << 5U,     ///< Editing a human motion.
  kLive = 1U << 6U,     ///< Retargeting a stream.
  kTrack = 1U << 7U,    ///< Making training arrays of motion trackers.
  kOneClip = 1U << 8U,  ///< Only a run of one clip: batches do not accept the option.
};
[[nodiscard]] constexpr OptionUse operator|(OptionUse a, OptionUse b) {
  return static_cast<OptionUse>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}

/// Properties of an option besides its name and its member.
struct OptionInfo {
  std::string type =
      {};  ///< Placeholder of its value in help: `FILE`, `N|source`; empty: the choices.
  std::string group = {};  ///< Group in the help; empty: a positional argument.
  std::string help = {};   ///< Human-readable: one or two sentences without a final full stop.
  double min = std::numeric_limits<double>::lowest();  ///< Range of numbers.
  double max = std::numeric_limits<double>::max();
  bool decides = true;  ///< Whether the bytes of a motion depend on it.
  OptionFile file = OptionFile::kNone;
  bool basic = false;                 ///< Shown in the short help.
  std::string letter = {};            ///< Short name on the command line; may be empty.
  bool required = false;              ///< Must be given on the command line.
  std::string none = {};              ///< Word for no choice of an optional enum; empty: none.
  OptionUse uses = OptionUse::kNone;  ///< Other commands that accept the option.
  bool recorded_if_given = false;     ///< Records omit it while it is an empty text, so that they
                                      ///< are those of versions without it.
};

/// An option bound to a struct member: one row of a table. Command line, JSON, run records and
/// documentation are all generated from these rows.
struct Option {
  std::string name;  ///< Name on the command line and in JSON: `source-fps`.
  OptionInfo info;
  std::vector<std::string> choices;  ///< Permitted values; empty: any.
  bool is_optional = false;          ///< An empty string means no choice.
  std::function<OptionValue()> get;
  /// Sets a value that check_option has accepted.
  std::function<Result<void>(const OptionValue&)> set;

  [[nodiscard]] bool is_flag() const { return std::holds_alternative<bool>(get()); }
  [[nodiscard]] bool is_list() const {
    return std::holds_alternative<std::vector<std::string>>(get());
  }
};

using OptionTable = std::vector<Option>;

/// A row for a member of any type that is converted to and from text.
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
            auto read = from_text(std::get<std::string>(value));
            if (!read) return failure(std::move(read).error());
            member = *std::move(read);
            return {};
          }};
}

/// A row for a member: a bool, a number or an optional one, a string, a list of strings, an enum
/// with named values, or an optional or a list of such enums. The member must outlive the row.
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
    // NaN, which no range contains, represents no choice.
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

/// Overload with group, value placeholder (empty: the choices) and help as separate arguments.
template <typename T>
Option option(std::string name, T& member, std::string group, std::string type, std::string help,
              OptionInfo info = {}) {
  info.group = std::move(group);
  info.type = std::move(type);
  info.help = std::move(help);
  return option(std::move(name), member, std::move(info));
}

/// Describes the permitted values: `a number from 0.1 to 1000000`, `true or false`, `one of fit,
/// gmr`.
[[nodiscard]] std::string expectation(const Option& row);

/// Checks the type, range and choices of a value. The kUsage error states the expected and the
/// found value, but not the name of the option.
[[nodiscard]] Result<void> check_option(const Option& row, const OptionValue& value);

/// Formats a value: shortest numbers, `true` and `false`, lists separated by commas.
[[nodiscard]] std::string to_text(const OptionValue& value);

/// Parses the value of an option. Errors as in check_option.
[[nodiscard]] Result<OptionValue> option_value(const Option& row, const std::string& text);

/// Finds an option by name. Returns null for an unknown name.
[[nodiscard]] const Option* find_option(const OptionTable& table, std::string_view name);
[[nodiscard]] std::vector<std::string> option_names(const OptionTable& table);

/// Appends the rows of a table to another.
void append(OptionTable& table, OptionTable rows);

/// The rows of a table that these commands accept, or the other rows; in order.
[[nodiscard]] OptionTable rows_for(OptionUse use, OptionTable table);
[[nodiscard]] OptionTable rows_not_for(OptionUse use, OptionTable table);

/// A table without the rows whose names another table has, or without the rows of these names.
[[nodiscard]] OptionTable without_rows_of(const OptionTable& taken, OptionTable table);
[[nodiscard]] OptionTable without(OptionTable table, std::initializer_list<std::string_view> names);

/// Names of the options whose values differ between two tables with the same rows.
[[nodiscard]] std::vector<std::string> changed_options(const OptionTable& table,
                                                       const OptionTable& other);

/// Whether records of motions contain the option: it affects a motion (OptionInfo::decides) and is
/// given, or its default is recorded too.
[[nodiscard]] bool is_recorded(const Option& row);

/// Formats the recorded options as a JSON object, in table order, including those with default
/// values.
[[nodiscard]] std::string options_text(const OptionTable& table);

/// Sets options from a file with a JSON object as options_text writes it; options that it lacks are
/// unchanged. All errors are reported together (kConfig): unknown names with the nearest one, wrong
/// types, values out of range. A value that stands for "not given" (0, -1) is always accepted.
/// @param what  description for messages: `the options of the fit`.
[[nodiscard]] Result<void> load_options(const std::string& file, const OptionTable& table,
                                        const std::string& what);

/// Option groups in help and docs.
inline constexpr const char* kInputGroup = "Input";
inline constexpr const char* kMotionFileGroup =
    "Motion files (detected and printed; these options override it)";
inline constexpr const char* kHumanGroup =
    "Human (detected and printed; these options override it)";
inline constexpr const char* kRobotGroup = "Robot and method";
inline constexpr const char* kTimeGroup = "Time";
inline constexpr const char* kOutputGroup = "Output";
inline constexpr const char* kGeneralGroup = "General";

/// Rows shared by several commands.
[[nodiscard]] Option memory_row(double& memory_gb);
[[nodiscard]] Option output_row(std::string& output);

/// Options for reading a robot motion, in commands about such motions and in runs from one robot to
/// another.
/// @param decides  whether the bytes of the result depend on them.
[[nodiscard]] OptionTable motion_file_table(MotionFileOptions& options, bool decides);

/// The rows of each options struct. The struct must outlive its rows.
[[nodiscard]] OptionTable source_table(SourceOptions& options);
[[nodiscard]] OptionTable human_table(HumanOptions& options);
[[nodiscard]] OptionTable part_table(PartOptions& options);
[[nodiscard]] OptionTable robot_table(RobotChoice& options);
[[nodiscard]] OptionTable solve_table(SolveOptions& options);
[[nodiscard]] OptionTable time_table(TimeOptions& options);
[[nodiscard]] OptionTable save_table(SaveOptions& options);
/// All rows of a run, in the order of a sidecar.
[[nodiscard]] OptionTable run_table(Run& run);

/// Parses a rate; nothing for `source`.
[[nodiscard]] Result<std::optional<double>> rate_from_text(const std::string& text);

/// Metres per unit from a unit name or a number; nothing for an empty text.
[[nodiscard]] Result<std::optional<double>> unit_from_text(const std::string& text);

/// Parses a travel factor; nothing for `auto`.
[[nodiscard]] Result<std::optional<double>> travel_from_text(const std::string& text);

/// Parses a time scale; nothing for `auto`.
[[nodiscard]] Result<std::optional<double>> time_scale_from_text(const std::string& text);

/// The option rows of FitOptions. Rows are named like its members, terms with hyphens.
[[nodiscard]] OptionTable fit_table(FitOptions& options);

/// Reads options from a JSON object with names of fit_table. Options that are missing keep their
/// values. Unknown names (with a suggestion), wrong types and values out of range are reported
/// together (kConfig).
/// @param file  name for messages.
[[nodiscard]] Result<FitOptions> parse_fit_options(std::string_view text, const std::string& file,
                                                   FitOptions options = {});

/// Enables or disables terms by name. The kUsage error for an unknown name suggests the nearest
/// one.
[[nodiscard]] Result<void> set_terms(FitOptions& options, std::span<const std::string> names,
                                     bool on);

/// Options of commands that read robot motions, for facts that a file does not state.
struct ReadingOptions : MotionFileOptions {
  double source_fps = 0.0;  ///< 0: as declared in the file.
  std::string motion;       ///< Name of one of several motions in a PBHC file.
};

[[nodiscard]] OptionTable reading_table(ReadingOptions& options);

/// Converts the options for the reader.
/// @param max_bytes  a larger motion is an error (memory_share).
[[nodiscard]] ReadMotionOptions read_motion_options(
    const ReadingOptions& options, std::size_t max_bytes = std::numeric_limits<std::size_t>::max());
/// @param source_fps  0: as declared in the file.
/// @param motion      name of one of several motions in a PBHC file.
[[nodiscard]] ReadMotionOptions read_motion_options(const MotionFileOptions& options,
                                                    double source_fps, const std::string& motion);

}  // namespace retarget
