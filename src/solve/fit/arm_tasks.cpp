#include "solve/fit/arm_tasks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <vector>

#include "retarget/so3.h"
#include "solve/fit/shorthand.h"

namespace retarget {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Axes, in the hand's link frame, of the hinges between forearm and hand that can move.
std::vector<Vector3d> wrist_axes(const FitModel& model, int forearm, int hand) {
  std::vector<Vector3d> axes;
  Quaterniond link_from_hand = Quaterniond::Identity();
  for (int link = hand; link != forearm;) {
    const KinematicTree::Link& joint = model.tree.links()[at(link)];
    const std::size_t dof = at(KinematicTree::dof_of(link));
    if (!joint.slides) {
      if (model.lower[dof] < model.upper[dof]) {
        axes.push_back(link_from_hand.conjugate() * Vector3d::UnitZ());
      } else {
        const double angle = model.lower[dof] - joint.reference;
        link_from_hand = exp_so3(angle * Vector3d::UnitZ()) * link_from_hand;
      }
    }
    link_from_hand = joint.parent_from_link.rotation * link_from_hand;
    link = joint.parent;
  }
  return axes;
}

// With several movable hinges, the axes beyond the first of these depend on joint positions.
void limit_hand_rotation(const FitModel& model, const FitTask& forearm, FitTask& hand) {
  if (!forearm.follows_rotation() || !model.tree.carries(forearm.link, hand.link)) return;
  const std::vector<Vector3d> axes = wrist_axes(model, forearm.link, hand.link);
  if (axes.size() > 1) return;
  hand.rotation_weight = 0.0;
  if (axes.empty()) {
    hand.twist_weight = 0.0;
  } else {
    hand.twist_axis = axes.front();
  }
}

}  // namespace

void relate_arm_tasks(const TrackingWeights& weights, FitModel& model) {
  for (FitTask& task : model.tasks) {
    const std::optional<LimbBone> part = limb_bone(task.bone);
    if (part != LimbBone::kArm && part != LimbBone::kHand) continue;
    const auto forearm = std::ranges::find_if(model.tasks, [&](const FitTask& one) {
      return limb_bone(one.bone) == LimbBone::kForeArm && side_of(one.bone) == side_of(task.bone);
    });
    if (forearm == model.tasks.end()) continue;
    if (part == LimbBone::kHand) {
      limit_hand_rotation(model, *forearm, task);
    } else {
      task.forearm = static_cast<int>(forearm - model.tasks.begin());
      task.straight_twist = weights.straight_upper_arm_twist;
    }
  }
}

}  // namespace retarget
