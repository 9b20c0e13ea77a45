// Normalises column names of CSV files from various tools.

#include "formats/robot_motion/csv_columns.h"

#include <algorithm>
#include <array>
#include <utility>

#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::string_view kJointEnd = "_joint";
// Path components that follow the joint and name its value.
constexpr std::array<std::string_view, 6> kValueWords = {"position", "pos", "q",
                                                         "angle",    "dof", "value"};

bool drop_prefix(std::string& text, std::string_view prefix) {
  if (text.size() <= prefix.size() || !text.starts_with(prefix)) return false;
  text.erase(0, prefix.size());
  return true;
}

bool drop_suffix(std::string& text, std::string_view suffix) {
  if (text.size() <= suffix.size() || !text.ends_with(suffix)) return false;
  text.erase(text.size() - suffix.size());
  return true;
}

std::string unit_from(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kUnits = {
      {{"rad", "rad"},
       {"radian", "rad"},
       {"radians", "rad"},
       {"deg", "deg"},
       {"degree", "deg"},
       {"degrees", "deg"},
       {"m", "m"},
       {"cm", "cm"},
       {"mm", "mm"},
       {"s", "s"},
       {"sec", "s"},
       {"seconds", "s"},
       {"ms", "ms"},
       {"milliseconds", "ms"},
       {"us", "us"},
       {"ns", "ns"}}};
  for (const auto& [word, unit] : kUnits) {
    if (text == word) return std::string(unit);
  }
  return {};
}

// Moves `(rad)` or `[rad]` at the end of a name to `unit`.
void take_unit(ColumnName& name) {
  for (const char* brackets : {"()", "[]"}) {
    const std::size_t open = name.plain.rfind(brackets[0]);
    if (!name.plain.ends_with(brackets[1]) || open == std::string::npos) continue;
    const std::string unit =
        unit_from(std::string_view(name.plain).substr(open + 1, name.plain.size() - open - 2));
    if (unit.empty()) continue;
    name.unit = unit;
    name.plain.erase(open);
    while (name.plain.ends_with('_')) name.plain.pop_back();
  }
}

ColumnName column_name(const std::string& cell) {
  ColumnName name{cell, lower_case(cell), {}};
  for (const char quote : {'"', '\''}) {
    std::erase(name.plain, quote);
  }
  const std::size_t begin = name.plain.find_first_not_of(" \t");
  name.plain.erase(0, std::min(begin, name.plain.size()));
  while (name.plain.ends_with(' ') || name.plain.ends_with('\t')) name.plain.pop_back();
  for (char& c : name.plain) {
    if (c == ' ' || c == '\t') c = '_';
    if (c == ':' || c == '.') c = '/';
  }
  take_unit(name);
  // Normalise `a//b` and `/a`.
  const auto doubled = std::unique(name.plain.begin(), name.plain.end(),
                                   [](char a, char b) { return a == '/' && b == '/'; });
  name.plain.erase(doubled, name.plain.end());
  if (name.plain.starts_with('/')) name.plain.erase(0, 1);
  return name;
}

// The first component that all paths share, with its slash; empty if there is none.
std::string shared_part(const std::vector<ColumnName>& names) {
  std::string shared;
  for (const ColumnName& name : names) {
    // The first column may lack the path: it is often a frame number or a time.
    const std::size_t slash = name.plain.find('/');
    if (slash == std::string::npos) {
      if (&name == &names.front() && names.size() > 1) continue;
      return {};
    }
    const std::string part = name.plain.substr(0, slash + 1);
    if (!shared.empty() && part != shared) return {};
    shared = part;
  }
  return shared;
}

}  // namespace

std::vector<ColumnName> column_names(const std::vector<std::string>& cells) {
  std::vector<ColumnName> names;
  names.reserve(cells.size());
  for (const std::string& cell : cells) names.push_back(column_name(cell));
  for (std::string part = shared_part(names); !part.empty(); part = shared_part(names)) {
    for (ColumnName& name : names) {
      if (name.plain.starts_with(part)) name.plain.erase(0, part.size());
    }
  }
  return names;
}

void take_unit_suffix(ColumnName& name) {
  const std::size_t last = name.plain.rfind('_');
  if (last == std::string::npos || !name.unit.empty()) return;
  name.unit = unit_from(std::string_view(name.plain).substr(last + 1));
  if (!name.unit.empty()) name.plain.erase(last);
}

JointNames::JointNames(const Robot& robot) : robot_(robot) {
  const auto add = [this](const std::string& name, int joint) {
    const auto [at, is_new] = by_plain_name_.emplace(name, joint);
    if (!is_new && at->second != joint) at->second.reset();
  };
  const auto count = static_cast<int>(robot.joints().size());
  for (int joint = 0; joint < count; ++joint) {
    if (!robot.joints()[joint].name.empty())
      add(column_name(robot.joints()[joint].name).plain, joint);
  }
  // Full names take precedence over shortened ones.
  const auto whole = by_plain_name_;
  for (int joint = 0; joint < count; ++joint) {
    std::string name = column_name(robot.joints()[joint].name).plain;
    if (drop_suffix(name, kJointEnd) && !whole.contains(name)) add(name, joint);
  }
}

std::optional<int> JointNames::find_plain(std::string name) const {
  const auto look_up = [this](const std::string& plain) {
    const auto found = by_plain_name_.find(plain);
    return found == by_plain_name_.end() ? std::nullopt : found->second;
  };
  if (const auto joint = look_up(name)) return joint;
  for (const std::string_view word : kValueWords) {
    if (drop_suffix(name, "_" + std::string(word))) break;
  }
  if (const auto joint = look_up(name)) return joint;
  for (const std::string_view prefix : {"dof_", "joint_", "q_"}) {
    std::string rest = name;
    if (!drop_prefix(rest, prefix)) continue;
    if (const auto joint = look_up(rest)) return joint;
  }
  return std::nullopt;
}

std::optional<int> JointNames::find(const ColumnName& name) const {
  if (const auto joint = robot_.find_joint(name.given)) return joint;
  if (const auto joint = find_plain(name.plain)) return joint;
  // Use the last component of a path, or the one before a word for the value.
  std::string path = name.plain;
  for (const std::string_view word : kValueWords) {
    if (drop_suffix(path, "/" + std::string(word))) break;
  }
  const std::size_t slash = path.rfind('/');
  return find_plain(slash == std::string::npos ? path : path.substr(slash + 1));
}

}  // namespace retarget
