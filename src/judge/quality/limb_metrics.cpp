#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "judge/quality/arm_jolts.h"
#include "judge/quality/joint_offset_metric.h"
#include "judge/quality/report_parts.h"
#include "judge/quality/similarity_metrics.h"
#include "judge/quality/tracking_measure.h"
#include "judge/quality/yaw_fit.h"
#include "retarget/measure.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "robot/anatomy/robot_hands.h"
#include "solve/hands/hand_track.h"

namespace retarget {

// The part of TrackingMeasure that compares limbs, hands and trunk of a robot with the human's.

namespace {

using Eigen::Vector3d;

// Angle between two limbs, degrees. A robot limb without length has no direction; its angle is 90.
double limb_angle(const Vector3d& of_human, const Vector3d& of_robot) {
  constexpr double kNoLength = 0.02;  // Fraction of the human limb's length.
  if (of_robot.norm() < kNoLength * of_human.norm()) return 90.0;
  return kDegreesPerRadian * angle_between(of_human, of_robot);
}

// LimbDirections::rank of a segment.
int rank_of(const LimbSegment& segment) {
  const Bone from = segment.from[0];
  if (from != segment.from[1] || side_of(from) != side_of(segment.to[0])) return 0;
  return from == Bone::kLeftUpLeg || from == Bone::kRightUpLeg || from == Bone::kLeftArm ||
                 from == Bone::kRightArm
             ? 1
             : 2;
}

bool is_of_legs(const LimbSegment& segment) {
  return std::ranges::all_of(segment.bones(), [](Bone bone) {
    const auto part = limb_bone(bone);
    return part == LimbBone::kUpLeg || part == LimbBone::kLeg || part == LimbBone::kFoot;
  });
}

// Aligns the lines of the trunk by the yaw of the hips. The yaw of the whole body depends mostly on
// the arms, which a constant rotation of the waist also rotates, and would hide that rotation.
void align_trunk_by_hips(std::vector<LimbDirections>& limbs) {
  YawFit yaw;
  for (const LimbDirections& limb : limbs) {
    if (limb.rank != 0 || !limb.of_legs) continue;
    for (std::size_t frame = 0; frame < limb.human.size(); ++frame) {
      if (limb.is_free(frame)) yaw.add(limb.human[frame], limb.robot[frame]);
    }
  }
  const Eigen::Quaterniond turn = yaw.rotation();
  for (LimbDirections& limb : limbs) {
    if (limb.rank != 0 || limb.of_legs) continue;
    for (Vector3d& direction : limb.human) direction = turn * direction;
  }
}

}  // namespace

// Empty if a bone of the limb is not tracked.
std::optional<LimbDirections> TrackingMeasure::directions_of(const LimbSegment& segment,
                                                             const RobotLimbs* limbs) const {
  BoneArray<const TrackedRow*> rows{nullptr};
  for (const Bone bone : segment.bones()) {
    rows[bone] = human_.has(bone) ? row_of(bone) : nullptr;
    if (rows[bone] == nullptr) return std::nullopt;
  }
  const auto place_in_body = [&](Bone bone) -> Vector3d {
    return limbs != nullptr ? limbs->body_from_joint[rows[bone]->bone] : Vector3d(Vector3d::Zero());
  };
  const auto end_of = [&](Bone bone) {
    return LimbEnd{rows[bone]->task->body, place_in_body(bone)};
  };
  LimbDirections found;
  found.rank = rank_of(segment);
  found.of_legs = is_of_legs(segment);
  if (found.rank > 0) found.side = side_of(segment.from[0]);
  found.from = {end_of(segment.from[0]), end_of(segment.from[1])};
  found.to = {end_of(segment.to[0]), end_of(segment.to[1])};
  for (int frame = 0; frame < frames_; ++frame) {
    found.human.push_back(robot_from_human_ * segment.direction([&](Bone bone) {
      return bone_pose(frame, bone).translation;
    }));
    found.robot.push_back(segment.direction([&](Bone bone) -> Vector3d {
      const Pose& body = tracks_.kept(frame, rows[bone]->body);
      return limbs != nullptr ? Vector3d(body * place_in_body(bone)) : body.translation;
    }));
    found.free.push_back(rests(frame, segment.bones()) ? 0 : 1);
  }
  return found;
}

// The axes of the hands with a rotation target, as limbs.
std::vector<LimbDirections> TrackingMeasure::hand_directions() const {
  std::vector<LimbDirections> found;
  for (const Bone bone : {Bone::kLeftHand, Bone::kRightHand}) {
    const TrackedRow* row = human_.has(bone) ? row_of(bone) : nullptr;
    if (row == nullptr || !row->task->compares_rotation()) continue;
    for (const int i : {0, 1, 2}) {
      const Vector3d axis = Vector3d::Unit(i);
      LimbDirections& hand = found.emplace_back();
      hand.from = {LimbEnd{row->task->body}, LimbEnd{row->task->body}};
      hand.to = {LimbEnd{row->task->body, axis}, LimbEnd{row->task->body, axis}};
      for (int frame = 0; frame < frames_; ++frame) {
        hand.human.push_back(2.0 * (wanted_rotation(frame, *row) * axis));
        hand.robot.push_back(2.0 * (tracks_.kept(frame, row->body).rotation * axis));
        hand.free.push_back(rests(frame, {&bone, 1}) ? 0 : 1);
      }
    }
  }
  return found;
}

// Whether the floor may constrain a limb. A robot with a fixed base has no floor.
bool TrackingMeasure::rests(int frame, std::span<const Bone> bones) const {
  constexpr double kLow = 0.25;  // Fraction of the leg length.
  if (draft_.clip.robot().fixed_base()) return false;
  return std::ranges::any_of(bones, [&](Bone bone) {
    return bone_pose(frame, bone).translation.z() - posture_.floor < kLow * leg_;
  });
}

std::vector<double> TrackingMeasure::limb_angles(const LimbDirections& limb) const {
  std::vector<double> angles;
  angles.reserve(limb.human.size());
  for (std::size_t i = 0; i < limb.human.size(); ++i) {
    angles.push_back(limb_angle(limb.human[i], limb.robot[i]));
  }
  return angles;
}

// Mean over the upright frames; NaN if the body is never upright.
double TrackingMeasure::mean_while_upright(const std::vector<double>& values) const {
  std::vector<double> counted;
  for (int frame = 0; frame < frames_; ++frame) {
    if (posture_.is_upright(frame)) counted.push_back(values[static_cast<std::size_t>(frame)]);
  }
  return mean(counted);
}

void TrackingMeasure::measure_limbs() const {
  // Limbs extend between joint centres if the robot's tree defines them, else between body origins.
  const Robot& robot = draft_.clip.robot();
  const auto limbs = robot.fixed_base() ? robot_arms(robot, config_) : robot_limbs(robot, config_);
  std::vector<LimbDirections> directions;
  std::vector<double> all, upright;
  std::vector<SegmentAngles> turned;
  for (const LimbSegment& segment : kLimbSegments) {
    auto found = directions_of(segment, limbs ? &*limbs : nullptr);
    if (!found) continue;
    std::vector<double> angles = limb_angles(*found);
    draft_.report.segments.push_back({segment.name, mean(angles), percentile(angles, 95.0)});
    all.insert(all.end(), angles.begin(), angles.end());
    upright.push_back(mean_while_upright(angles));
    if (!found->of_legs && found->rank < 2) {
      turned.push_back({found->rank == 1, std::move(angles)});
    }
    directions.push_back(std::move(*found));
  }
  if (all.empty()) return;
  draft_.set("limb_angle_deg", mean(all), percentile(all, 95.0));
  if (posture_.ever_upright(frames_)) {
    draft_.set("worst_limb_angle_deg", *std::ranges::max_element(upright));
  }
  measure_arm_jolts(draft_, posture_, turned);
  const double fps = draft_.clip.rate().fps();
  if (const auto lag = limb_lag(directions, fps)) draft_.set("lag_s", *lag);
  const auto arms = fast_speed_kept(directions, false, fps);
  const auto legs = fast_speed_kept(directions, true, fps);
  if (arms) draft_.set("fast_arm_pct", 100.0 * *arms);
  if (legs) draft_.set("fast_leg_pct", 100.0 * *legs);
  align_trunk_by_hips(directions);
  std::erase_if(directions, [](const LimbDirections& limb) { return limb.of_legs; });
  measure_joint_offsets(draft_, limits_, directions, hand_directions());
}

// Empty if a hip or a shoulder is not tracked. Like measure_limbs(), uses body origins if the tree
// does not define the joint centres.
std::optional<TrunkBodies> TrackingMeasure::trunk_bodies() const {
  const auto limbs = robot_limbs(draft_.clip.robot(), config_);
  TrunkBodies trunk;
  std::size_t next = 0;
  for (const Bone bone : kTrunkBones) {
    const TrackedRow* row = row_of(bone);
    if (row == nullptr) return std::nullopt;
    trunk.bodies[next] = row->body;
    trunk.body_from_joint[next++] =
        limbs ? limbs->body_from_joint[row->bone] : Vector3d(Vector3d::Zero());
  }
  return trunk;
}

namespace {

// Hands that are relaxed or that the body solver includes keep their fingers still.
bool fingers_move(const RobotClip& clip) {
  constexpr double kStill = 0.02;  // Radians or metres.
  for (const auto& hand : find_hands(clip.robot())) {
    if (!hand) continue;
    for (const int joint : hand->variables) {
      const int at = clip.robot().joints()[joint].qpos_address;
      double lowest = INFINITY, highest = -INFINITY;
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        lowest = std::min(lowest, clip.qpos(frame)[at]);
        highest = std::max(highest, clip.qpos(frame)[at]);
      }
      if (highest - lowest > kStill) return true;
    }
  }
  return false;
}

}  // namespace

void add_hands(const RobotClip& clip, const Clip& source, const BoneMap& map,
               QualityReport& report) {
  HandErrors errors = measure_hands(source, map, clip);
  const QualityOptions options;
  const ReportBuilder draft{clip, options, report};
  for (double& angle : errors.angles) angle *= kDegreesPerRadian;
  for (double& gap : errors.touching_gaps) gap *= kInCm;
  if (!errors.angles.empty()) {
    const double p95 = percentile(errors.angles, 95.0);
    draft.set("finger_angle_deg", mean(errors.angles), p95);
    if (fingers_move(clip)) draft.set("driven_finger_angle_deg", mean(errors.angles), p95);
  }
  if (!errors.touching_gaps.empty()) {
    draft.set("touch_gap_cm", mean(errors.touching_gaps), percentile(errors.touching_gaps, 95.0));
  }
  std::ranges::sort(report.values, {}, &MetricValue::metric);
}

}  // namespace retarget
