#pragma once

#include <span>
#include <vector>

#include "anatomy/robot_hands.h"
#include "human/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// The source's hands that a robot's follow; empty where it does nothing with them: the robot has no
/// hand on that side, or the source none whose fingers move.
/// @param part  frames of the clip.
[[nodiscard]] SourceHands followed_hands(const Clip& clip, const BoneMap& map,
                                         const RobotHands& robot, HandsRule rule,
                                         const FrameRange& part);

/// What a method makes of HandsRule::kAuto.
[[nodiscard]] HandsRule hands_rule(HandsRule rule, Method method);

/// Bounds that hold for a track as it is printed.
struct HandBounds {
  double max_speed = 14.4;  ///< rad/s; no hinge is faster, whatever its own limit.
  double max_step = 0.48;   ///< rad; no hinge moves farther between two frames.
  int decimals = 6;         ///< Digits that are printed.
};

/// Positions of the joints of a robot's hands, frame by frame.
class HandTrack {
 public:
  HandTrack() = default;

  /// Solves the hands: frame by frame from the source (HandSolver), then smoothed without delay over
  /// about 24 ms, and brought inside ranges and speed limits, which hold for the numbers as printed. A hand
  /// that follows nothing is relaxed in all frames.
  /// @param source  as the robot's motion takes it, frame by frame.
  HandTrack(const Clip& source, const SourceHands& followed, const Robot& robot,
            const RobotHands& hands, const LimitSet& limits, const HandBounds& bounds = {});

  [[nodiscard]] bool empty() const { return addresses_.empty(); }
  /// Sets the hands' joints in a configuration.
  void write(int frame, std::span<double> qpos) const;

 private:
  void add(const Clip& source, const SourceHand* followed, const Robot& robot,
           const RobotHand& hand, const LimitSet& limits, const HandBounds& bounds);

  std::vector<int> addresses_;                  // into a configuration
  std::vector<std::vector<double>> positions_;  // of each of them, by frame
};

}  // namespace retarget
