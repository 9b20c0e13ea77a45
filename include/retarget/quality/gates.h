#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/quality/report.h"

namespace retarget {

/// Bounds that a metric must keep, inclusive.
struct Gate {
  std::string metric;  ///< Key.
  std::optional<double> least, most;
  /// The bounds are for a robot with legs (hip to knee to ankle) of this length, metres; those of
  /// others are larger or smaller as their legs are. Nothing: for every robot.
  std::optional<double> leg = std::nullopt;
};

/// Gates, at most one for each metric.
class Gates {
 public:
  /// Takes the place of the gate on the same metric; one without bounds removes it.
  void set(Gate gate);
  void clear() { gates_.clear(); }
  [[nodiscard]] const std::vector<Gate>& all() const { return gates_; }

  /// Sets every gate of a file: JSON
  /// `{"gates": {KEY: {"min": NUMBER, "max": NUMBER, "leg_m": NUMBER}, ...}}`; a number is a
  /// maximum, `null` removes the gate. Other members of the file are for people.
  /// kConfig errors name all faults, unknown metrics with the nearest one.
  [[nodiscard]] Result<void> add_json(std::string_view text, const std::string& file);
  [[nodiscard]] Result<void> add_file(const std::string& path);

  /// Holds a report against the gates and writes what came of it into it.
  void judge(QualityReport& report) const;

 private:
  std::vector<Gate> gates_;
};

}  // namespace retarget
