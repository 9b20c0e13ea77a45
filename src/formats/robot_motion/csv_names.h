#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A column name without common decorations.
struct ColumnName {
  std::string given;  ///< As in the file.
  /// Lower case, with `_` for spaces, without quotes and units; path components separated by `/`.
  std::string plain;
  std::string unit;  ///< `rad`, `deg`, `m`, `cm`, `mm`, `s`, `ms`, `us`, `ns`, or empty.
};

/// Normalises the names of a header; removes a first path component that all of them share.
[[nodiscard]] std::vector<ColumnName> column_names(const std::vector<std::string>& cells);

/// Moves a unit suffix after `_` from the name to `unit`: `time_ms`.
void take_unit_suffix(ColumnName& name);

/// Finds the joint that a column name refers to.
class JointNames {
 public:
  explicit JointNames(const Robot& robot);
  /// Index into Robot::joints().
  [[nodiscard]] std::optional<int> find(const ColumnName& name) const;

 private:
  [[nodiscard]] std::optional<int> find_plain(std::string name) const;

  const Robot& robot_;
  std::map<std::string, std::optional<int>, std::less<>> by_plain_name_;  // No value: ambiguous.
};

}  // namespace retarget
