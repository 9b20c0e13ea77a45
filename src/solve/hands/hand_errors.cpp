#include "solve/hands/hand_errors.h"

#include <algorithm>
#include <cmath>

#include "retarget/so3.h"
#include "solve/hands/hand_solver.h"
#include "solve/hands/hand_target.h"
#include "solve/hands/hand_track.h"

namespace retarget {
namespace {

void measure_hand(const Clip& source, const SourceHand& followed, const RobotClip& motion,
                  const RobotHand& hand, HandErrors& errors) {
  const HandMatch match(hand);
  HandPosture posture(hand);
  HandPoser poser(source, followed);
  HandShape shape;
  HandTarget target;
  HandTarget::Parts parts;
  Eigen::VectorXd positions(static_cast<Eigen::Index>(hand.joints.size()));
  const int frames = std::min(source.frame_count(), motion.frame_count());
  for (int frame = 0; frame < frames; ++frame) {
    if (!poser.shape(frame, shape)) continue;
    match.target(shape, target);
    const auto qpos = motion.qpos(frame);
    for (std::size_t j = 0; j < hand.joints.size(); ++j) {
      const RobotJoint& joint = motion.robot().joints()[hand.joints[j].joint];
      positions[static_cast<Eigen::Index>(j)] = qpos[joint.qpos_address];
    }
    posture.set(positions);
    for (const RobotFinger& finger : hand.fingers) {
      const auto f = static_cast<std::size_t>(finger.finger);
      if (finger.finger == Finger::kThumb) continue;
      posture.directions(finger, parts);
      for (int k = 0; !hand.is_gripper && k < target.parts[f].count; ++k) {
        errors.angles.push_back(
            angle_between(parts.directions[static_cast<std::size_t>(k)],
                          target.parts[f].directions[static_cast<std::size_t>(k)]));
      }
      if (!target.has_gap[f] || target.gap[f] > kTouchingGap * finger.length) continue;
      errors.touching_gaps.push_back(std::abs(posture.gap(finger)));
    }
  }
}

}  // namespace

HandErrors measure_hands(const Clip& source, const BoneMap& map, const RobotClip& motion) {
  HandErrors errors;
  const RobotHands hands = find_hands(motion.robot());
  const SourceHands followed =
      followed_hands(source, map, hands, HandsRule::kFollow, {0, source.frame_count()});
  for (std::size_t side = 0; side < hands.size(); ++side) {
    if (!followed[side]) continue;
    measure_hand(source, *followed[side], motion, *hands[side], errors);
  }
  return errors;
}

}  // namespace retarget
