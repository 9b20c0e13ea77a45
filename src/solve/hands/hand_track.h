#pragma once

#include <span>
#include <vector>

#include "base/math/step_bounds.h"
#include "human/skeleton/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "robot/anatomy/robot_hands.h"

namespace retarget {

/// The source's hands that a robot's hands follow: those whose fingers move, or hold a pose that is
/// not a default one (fingers_are_closed()); with HandsRule::kFollow also those that hold any pose
/// other than the skeleton's rest pose. Empty for other rules.
/// @param part  relevant frames of the clip; usually the whole clip, so that a pose held during an
///     excerpt is followed.
[[nodiscard]] SourceHands followed_hands(const Clip& clip, const BoneMap& map,
                                         const RobotHands& robot, HandsRule rule,
                                         const FrameRange& part);

/// The rule for a method: HandsRule::kAuto is HandsRule::kOff with Method::kGmr.
[[nodiscard]] HandsRule hands_rule(HandsRule rule, Method method);

/// Bounds of a HandTrack, which its rounded output also keeps.
struct HandBounds {
  double max_speed = 14.4;  ///< Speed limit of hinges, rad/s, in addition to their own limits.
  double max_step = 0.48;   ///< Step limit of hinges between two frames, rad.
  int decimals = 6;         ///< Digits of the rounded output.
  std::vector<PrintedUnits> printed = {{}};  ///< Units in which it is rounded.
};

/// Joint positions of a robot's hands, by frame.
class HandTrack {
 public:
  HandTrack() = default;

  /// Solves the hands frame by frame (HandSolver), with steps of at most 1/120 s, smooths the result
  /// with a zero-phase filter of about 24 ms, and clamps it to ranges and speed limits, which the
  /// rounded output also keeps. A hand without a source hand is relaxed in all frames.
  /// @param source  clip whose frames correspond to those of the robot's motion.
  HandTrack(const Clip& source, const SourceHands& followed, const Robot& robot,
            const RobotHands& hands, const LimitSet& limits, const HandBounds& bounds = {});

  [[nodiscard]] bool empty() const { return addresses_.empty(); }
  /// Frames in which HandSolver failed.
  [[nodiscard]] const std::vector<SolverFailure>& failures() const { return failures_; }
  /// Writes the hands' joint positions into a configuration.
  void write(int frame, std::span<double> qpos) const;

 private:
  void add(const Clip& source, const SourceHand* followed, const Robot& robot,
           const RobotHand& hand, const LimitSet& limits, const HandBounds& bounds);
  void note_failure(Side side, int frame);

  std::vector<SolverFailure> failures_;
  std::vector<int> addresses_;                  // Addresses in qpos.
  std::vector<std::vector<double>> positions_;  // For each address, by frame.
};

/// Deviation of a robot's fingers from the human's.
struct HandErrors {
  /// Angles between the parts of the robot's fingers and the human's at the same fractions of their
  /// lengths, both relative to the palm, radians; for all parts, fingers and frames. Excludes
  /// thumbs, whose positions in the palm differ.
  std::vector<double> angles;
  /// Absolute gaps between the surfaces of the robot's thumb and a finger, metres, in frames in
  /// which those of the human touch.
  std::vector<double> touching_gaps;
};

/// Measures the deviations of a motion. Empty for robots without hands and for sources without
/// fingers that HandsRule::kAuto follows.
/// @param source  clip whose frames correspond to those of `motion`; the shorter one determines the
///     length.
[[nodiscard]] HandErrors measure_hands(const Clip& source, const BoneMap& map,
                                       const RobotClip& motion);

}  // namespace retarget
