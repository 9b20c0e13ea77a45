#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/scene/key_grid.h"
#include "formats/scene/scene.h"
#include "formats/scene/scene_takes.h"
#include "retarget/error.h"

namespace retarget {

/// The times at which the motion of a scene is sampled: the frames of its keys where they are
/// evenly spaced, otherwise frames at the file's own rate or at 30 fps.
class SceneTimes {
 public:
  /// @param choice      interval and take; without a take there are no keys.
  /// @param chain       nodes whose keys are used; nodes_of_chain().
  /// @param source_fps  requested rate in Hz.
  SceneTimes(const SceneGraph& scene, const SceneMotionChoice& choice,
             const std::vector<bool>& chain, const std::optional<double>& source_fps);

  [[nodiscard]] const FrameRate& rate() const { return rate_; }
  /// Why this is the rate, for users.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// May exceed any integer.
  [[nodiscard]] double frame_count() const;
  /// Time of a frame: that of a key within rounding, so that steps are sampled at their key.
  [[nodiscard]] double seconds_of(int frame) const;

  /// Error (kInput): the keys are too dense for frames, so that frames would be lost.
  [[nodiscard]] Result<void> check(const std::string& file_name) const;
  /// About frames that are not keys, keys that are not frames, and keys outside of the take.
  [[nodiscard]] std::vector<Warning> warnings() const;
  /// Names the largest gap between keys if it is most of the motion; otherwise empty. A key far
  /// from all others is usually a mistake.
  [[nodiscard]] std::string far_key_hint() const;

 private:
  void choose_rate(double own_fps, const std::optional<double>& source_fps);
  // Samples at the keys, with `ratio` frames from each to the next.
  void use_keys(int ratio);
  [[nodiscard]] std::size_t keys_inside() const;
  [[nodiscard]] std::string outside_text() const;

  std::vector<double> keys_;        // Ascending, different.
  double begin_ = 0.0, end_ = 0.0;  // Interval of the take, seconds.
  std::optional<KeyGrid> grid_;     // Frames of all keys, at rate_ if on_keys_.
  FrameRate rate_;
  std::string reason_;
  std::string fallback_;  // Why the rate is a default; empty: it is not one.
  bool is_requested_ = false, on_keys_ = false;
  std::int64_t first_ = 0, last_ = 0;  // Frames of the first and last key in the interval.
};

}  // namespace retarget
