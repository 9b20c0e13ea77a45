#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "batch/find_inputs.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Removes the first element of a pattern, `[...]` or a character; returns whether it matches
// `letter`.
bool take_one(std::string_view& pattern, char letter) {
  const std::size_t close = pattern.find(']', 2);
  if (pattern.front() != '[' || close == std::string_view::npos) {
    const bool same = pattern.front() == '?' || pattern.front() == letter;
    pattern.remove_prefix(1);
    return same;
  }
  std::string_view set = pattern.substr(1, close - 1);
  pattern.remove_prefix(close + 1);
  const bool excludes = set.front() == '!' || set.front() == '^';
  if (excludes) set.remove_prefix(1);
  bool found = false;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool range = i + 2 < set.size() && set[i + 1] == '-';
    found = found || (range ? set[i] <= letter && letter <= set[i + 2] : set[i] == letter);
    if (range) i += 2;
  }
  return found != excludes;
}

// Backtracks only to the last `*`, so that the time is bounded by the product of the lengths.
bool matches(std::string_view pattern, std::string_view name) {
  std::string_view after_star;
  std::optional<std::string_view> rest;  // Rest of the name for the next attempt at the last `*`.
  for (;;) {
    if (!pattern.empty() && pattern.front() == '*') {
      pattern.remove_prefix(1);
      after_star = pattern;
      rest = name;
      continue;
    }
    if (name.empty() && pattern.empty()) return true;
    if (!name.empty() && !pattern.empty() && take_one(pattern, name.front())) {
      name.remove_prefix(1);
      continue;
    }
    if (!rest || rest->empty()) return false;
    rest->remove_prefix(1);
    name = *rest;
    pattern = after_star;
  }
}

}  // namespace

// File names on Windows are case-insensitive.
bool matches_pattern(const std::string& pattern, const std::string& name) {
  return matches(lower_case(pattern), lower_case(name));
}

namespace {

// Adds the paths below `base` that match the rest of a pattern.
void add_matches(const std::string& base, std::string_view pattern,
                 std::vector<std::string>& found) {
  const std::size_t slash = pattern.find('/');
  const std::string_view part = pattern.substr(0, slash);
  const auto go_on = [&](const std::string& path) {
    std::error_code ignored;
    if (slash == std::string_view::npos) {
      if (fs::exists(fs::symlink_status(path, ignored))) found.push_back(path);
    } else {
      add_matches(path + "/", pattern.substr(slash + 1), found);
    }
  };
  if (part.find_first_of("*?[") == std::string_view::npos) {
    return go_on(base + std::string(part));
  }
  for (const fs::path& file : files_in_folder(base.empty() ? "." : base)) {
    const std::string name = file.filename().generic_string();
    if (name.starts_with('.') && !part.starts_with('.')) continue;
    if (matches_pattern(std::string(part), name)) go_on(base + name);
  }
}

}  // namespace

std::vector<std::string> files_of_pattern(const std::string& pattern) {
  std::vector<std::string> found;
  add_matches("", pattern, found);
  return found;
}

}  // namespace retarget
