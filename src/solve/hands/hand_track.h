#pragma once

#include <span>
#include <vector>

#include "human/skeleton/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "robot/anatomy/robot_hands.h"

namespace retarget {

/// The source's hands that a robot's hands follow; empty on a side without a robot hand, or on
/// which the source has no moving fingers.
/// @param part  frames of the clip to consider.
[[nodiscard]] SourceHands followed_hands(const Clip& clip, const BoneMap& map,
                                         const RobotHands& robot, HandsRule rule,
                                         const FrameRange& part);

/// Resolves HandsRule::kAuto for a method.
[[nodiscard]] HandsRule hands_rule(HandsRule rule, Method method);

/// Bounds of a track that also hold for its rounded output.
struct HandBounds {
  double max_speed = 14.4;  ///< Speed limit of hinges, rad/s, in addition to their own limits.
  double max_step = 0.48;   ///< Step limit of hinges between two frames, rad.
  int decimals = 6;         ///< Digits of the rounded output.
};

/// Joint positions of a robot's hands, by frame.
class HandTrack {
 public:
  HandTrack() = default;

  /// Solves the hands frame by frame from the source (HandSolver), smooths the result without delay
  /// over about 24 ms, and clamps it to ranges and speed limits, which also hold for the rounded
  /// output. A hand that follows nothing is relaxed in all frames.
  /// @param source  clip whose frames correspond to those of the robot's motion.
  HandTrack(const Clip& source, const SourceHands& followed, const Robot& robot,
            const RobotHands& hands, const LimitSet& limits, const HandBounds& bounds = {});

  [[nodiscard]] bool empty() const { return addresses_.empty(); }
  /// Frames that HandSolver could not solve.
  [[nodiscard]] const std::vector<SolverFailure>& failures() const { return failures_; }
  /// Writes the hands' joint positions into a configuration.
  void write(int frame, std::span<double> qpos) const;

 private:
  void add(const Clip& source, const SourceHand* followed, const Robot& robot,
           const RobotHand& hand, const LimitSet& limits, const HandBounds& bounds);
  void note_failure(Side side, int frame);

  std::vector<SolverFailure> failures_;
  std::vector<int> addresses_;                  // Addresses in a configuration.
  std::vector<std::vector<double>> positions_;  // For each address, by frame.
};

/// Deviation of a robot's fingers from the human's.
struct HandErrors {
  /// Angles between the parts of the robot's fingers and those of the human's at the same shares of
  /// their lengths, both relative to the palm, radians; for all parts, fingers and frames. Excludes
  /// thumbs, which are placed differently.
  std::vector<double> angles;
  /// Absolute distances between the robot's thumb and finger, skin to skin, metres, in frames in
  /// which the human's touch.
  std::vector<double> touching_gaps;
};

/// Returns empty lists for robots without hands, and for sources without moving fingers.
/// @param source  clip whose frames correspond to those of `motion`; the shorter one determines the
///     length.
[[nodiscard]] HandErrors measure_hands(const Clip& source, const BoneMap& map,
                                       const RobotClip& motion);

}  // namespace retarget
