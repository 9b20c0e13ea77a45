#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// The name of a column without what people put around it.
struct ColumnName {
  std::string given;  ///< As in the file.
  /// Lower case, blanks as `_`, without quotes and units; parts divided by `/`.
  std::string plain;
  std::string unit;  ///< `rad`, `deg`, `m`, `cm`, `mm`, `s`, `ms`, `us`, `ns`, or nothing.
};

/// The names of a header's cells; a first part of a path that all of them have is left out.
[[nodiscard]] std::vector<ColumnName> column_names(const std::vector<std::string>& cells);

/// Takes a unit off the end of a name that is followed by `_`: `time_ms`.
void take_unit_suffix(ColumnName& name);

/// Finds the joint that a column is named after.
class JointNames {
 public:
  explicit JointNames(const Robot& robot);
  /// Index into Robot::joints().
  [[nodiscard]] std::optional<int> find(const ColumnName& name) const;

 private:
  [[nodiscard]] std::optional<int> find_plain(std::string name) const;

  const Robot& robot_;
  std::map<std::string, std::optional<int>, std::less<>> by_plain_name_;  // nothing: of several
};

}  // namespace retarget
