#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "motion/resample.h"
#include "retarget/clip.h"
#include "retarget/time_scale.h"

namespace retarget {

/// A step between two frames that must be slower, and the reason.
struct StepNeed {
  enum Kind : unsigned char { kSpeed, kTorque };
  static constexpr std::size_t kKinds = 2;

  int step = 0;  ///< Step of the motion that was solved with the current pace.
  Kind kind = kSpeed;
  double severity = 0.0;  ///< Falls when slowing helps.
  double slower = 1.0;    ///< Factor for the pace.
  std::string cause;
};

/// Decides where and by how much to slow a motion down, from the limits that its solutions exceed.
class TimePlanner {
 public:
  /// @param duration  duration of the source, seconds.
  /// @param rate      frame rate of the motion.
  TimePlanner(double duration, const FrameRate& rate);

  /// The current pace; empty at first.
  [[nodiscard]] const TimeScale& scale() const { return scale_; }
  /// Source time of a step of the motion with the current pace: its beginning, seconds.
  [[nodiscard]] double source_time(int step) const;
  [[nodiscard]] double pace_at(double source) const { return warp_.pace(source); }

  /// Raises the pace for the needs of a motion that was solved with the current pace. Restores the
  /// original time where slowing did not help. Returns whether the pace changed.
  bool take(const std::vector<StepNeed>& needs);
  /// Restores the original time from `begin` to `end`, because slowing does not help there.
  void restore(double begin, double end);

  /// The decision; nothing if there is nothing to report.
  [[nodiscard]] std::optional<TimeScale> decision();

 private:
  // The required pace between two knots.
  struct PlaceNeed {
    double pace = 1.0;
    double first = 0.0;  // Severity before it was slowed.
    std::string cause;
    bool is_hopeless = false;
  };

  [[nodiscard]] std::size_t place(double source) const;
  [[nodiscard]] bool raise(PlaceNeed& need, const StepNeed& step, double pace) const;
  void set_pace();
  void find_stretches();
  void add_left(std::size_t i, double begin, double end);

  double duration_;
  FrameRate rate_;
  std::array<std::vector<PlaceNeed>, StepNeed::kKinds> needs_;  // By kind and knot interval.
  TimeScale scale_;
  TimeWarp warp_;
};

}  // namespace retarget
