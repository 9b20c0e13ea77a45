#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edit/ground_pose.h"
#include "retarget/clip.h"
#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/option_name.h"
#include "retarget/pose.h"
#include "retarget/skeleton_points.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Closer to upside down than this, the hips have no heading and keep the previous one.
constexpr double kNoHeading = 1e-3;

bool is_moved(const Clip& clip, int joint) {
  constexpr double kStill = 1e-9;
  const auto slot = static_cast<std::size_t>(clip.skeleton().translation_slot(joint));
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    const auto &turn = clip.rotations(frame)[joint], &first = clip.rotations(0)[joint];
    const Eigen::Vector3d way = clip.translations(frame)[slot] - clip.translations(0)[slot];
    if (way.norm() > kStill || 1.0 - std::abs(turn.dot(first)) > kStill) return true;
  }
  return false;
}

}  // namespace

bool moves_freely(const Joint& joint) {
  int positions = 0, rotations = 0;
  for (const Channel channel : joint.channels) {
    positions += is_position(channel) ? 1 : 0;
    rotations += is_rotation(channel) ? 1 : 0;
  }
  return positions == 3 && rotations >= 3;
}

GroundPose GroundPose::inverse() const {
  const GroundPose turned{Eigen::Vector2d::Zero(), -heading};
  return {-(turned * position), -heading};
}

Pose GroundPose::in_space() const {
  const auto [sine, cosine] = portable::sin_cos(0.5 * heading);
  return {Eigen::Quaterniond(cosine, 0.0, 0.0, sine), {position.x(), position.y(), 0.0}};
}

GroundPose operator*(const GroundPose& a, const GroundPose& b) {
  return {a * b.position, a.heading + b.heading};
}

Eigen::Vector2d operator*(const GroundPose& pose, const Eigen::Vector2d& point) {
  const auto [sine, cosine] = portable::sin_cos(pose.heading);
  return {pose.position.x() + cosine * point.x() - sine * point.y(),
          pose.position.y() + sine * point.x() + cosine * point.y()};
}

GroundPose turn_about(const Eigen::Vector2d& point, double angle) {
  const GroundPose turn{Eigen::Vector2d::Zero(), angle};
  return {point - turn * point, angle};
}

Pose world_from_joint(const Clip& clip, int frame, int joint) {
  Pose pose;
  for (; joint >= 0; joint = clip.skeleton().joint(joint).parent) {
    pose = Pose{clip.rotations(frame)[joint], clip.translation(frame, joint)} * pose;
  }
  return pose;
}

BodyMover::BodyMover(int joint, const Calibration& calibration)
    : joint_(joint),
      metres_per_unit_(calibration.metres_per_unit),
      human_from_source_(calibration.human_from_source) {}

Result<BodyMover> BodyMover::of(const Clip& clip, const Calibration& calibration,
                                const Clip* with) {
  const Skeleton& skeleton = clip.skeleton();
  std::vector<int> chain;
  for (int joint = calibration.bones[Bone::kHips].position_joint; joint >= 0;
       joint = skeleton.joint(joint).parent) {
    chain.push_back(joint);
  }
  const auto is_free = [&](int joint) { return moves_freely(skeleton.joint(joint)); };
  std::erase_if(chain, [&](int joint) { return !is_free(joint); });
  const auto moving = std::ranges::find_if(chain.rbegin(), chain.rend(), [&](int joint) {
    return is_moved(clip, joint) || (with != nullptr && is_moved(*with, joint));
  });
  if (moving != chain.rend()) chain.erase(moving.base(), chain.end());
  bool moves_all = !chain.empty();
  for (const BoneSource& bone : calibration.bones) {
    if (!moves_all || bone.position_joint < 0) continue;
    moves_all = is_above(skeleton, chain.back(), bone.position_joint);
  }
  if (!moves_all) {
    return input_failure(
        {},
        "no joint moves the whole body: neither the root nor a joint between it and the hips has "
        "three position and three rotation channels",
        "use retarget edit transfer to move the motion to a skeleton with such a joint");
  }
  return BodyMover(chain.back(), calibration);
}

void BodyMover::move(Clip& clip, int frame, const Pose& move) const {
  const Skeleton& skeleton = clip.skeleton();
  const Pose world_from_parent = world_from_joint(clip, frame, skeleton.joint(joint_).parent);
  const Pose in_source{human_from_source_.conjugate() * move.rotation * human_from_source_,
                       human_from_source_.conjugate() * move.translation / metres_per_unit_};
  Eigen::Quaterniond& rotation = clip.rotations(frame)[joint_];
  Eigen::Vector3d& translation = clip.translations(frame)[skeleton.translation_slot(joint_)];
  const Pose moved =
      world_from_parent.inverse() * (in_source * (world_from_parent * Pose{rotation, translation}));
  rotation = moved.rotation.normalized();
  translation = moved.translation;
}

void BodyMover::move_all(Clip& clip, const Pose& over_all) const {
  for (int frame = 0; frame < clip.frame_count(); ++frame) move(clip, frame, over_all);
}

std::optional<double> heading_of(const Eigen::Quaterniond& turn) {
  if (turn.z() * turn.z() + turn.w() * turn.w() <= kNoHeading) return std::nullopt;
  return 2.0 * portable::atan2(turn.z(), turn.w());
}

std::vector<GroundPose> hips_over_ground(const HumanClip& human) {
  const Eigen::Quaterniond hips_from_t_pose(
      Eigen::Matrix3d(canonical_t_pose(Bone::kHips).transpose()));
  std::vector<GroundPose> places;
  places.reserve(static_cast<std::size_t>(human.frame_count));
  double before = 0.0;
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const Pose& hips = human.frame(frame)[Bone::kHips];
    const double heading = heading_of(hips.rotation * hips_from_t_pose).value_or(before);
    before += std::remainder(heading - before, 2.0 * std::numbers::pi);
    places.push_back({hips.translation.head<2>(), before});
  }
  return places;
}

// Edits of position: floor height, rotation, translation.

Result<double> floor_height(const Clip& clip, const Calibration& calibration) {
  const Skeleton& skeleton = clip.skeleton();
  // In a clip shorter than the shortest contact, a still foot counts as standing.
  ContactOptions standing;
  standing.shortest = std::min(standing.shortest, clip.frame_count() * clip.rate().frame_time());
  ContactPlan contacts = find_contacts(to_human(clip, calibration), standing);
  std::array<std::vector<SkeletonPoint>, 2> feet;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = side_bone(kSides[foot], LimbBone::kFoot);
    contacts.phases[foot] = on_floor(std::move(contacts.phases[foot]));
    feet[foot] = points_below(skeleton, calibration.bones[bone].position_joint);
  }
  const Eigen::RowVector3d up = calibration.human_from_source.row(2) * calibration.metres_per_unit;
  std::vector<double> heights;
  std::vector<Pose> poses(static_cast<std::size_t>(skeleton.joint_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    for (int foot = 0; foot < 2; ++foot) {
      if (!contacts.in_contact(foot, frame)) continue;
      double lowest = std::numeric_limits<double>::infinity();
      for (const SkeletonPoint& point : feet[foot]) {
        lowest = std::min(lowest, up.dot(world_from_point(point, poses).translation));
      }
      heights.push_back(lowest);
    }
  }
  if (heights.empty()) {
    return input_failure({}, "no foot is ever in contact: cannot infer the floor",
                         RETARGET_OPTION("floor") " H sets the floor height in metres");
  }
  return median(std::move(heights));
}

Result<Clip> put_on_floor(Clip clip, const Calibration& calibration, double floor) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, {Eigen::Quaterniond::Identity(), {0.0, 0.0, -floor}});
  return clip;
}

Result<Clip> turn_clip(Clip clip, const Calibration& calibration, double angle) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  if (clip.frame_count() == 0) return clip;
  const HumanClip first = to_human(cut(clip, 0, 1), calibration);
  mover.move_all(clip, turn_about(hips_over_ground(first).front().position, angle).in_space());
  return clip;
}

Result<Eigen::Vector2d> way_from_text(std::string_view text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  const auto x = number_from_text(text.substr(0, comma)),
             y = number_from_text(text.substr(std::min(comma + 1, text.size())));
  if (x && y) return Eigen::Vector2d(*x, *y);
  return usage_failure("a move must be X,Y in metres, up to 1000000, found \"" + std::string(text) +
                       "\"");
}

Result<Clip> move_clip(Clip clip, const Calibration& calibration, const Eigen::Vector2d& way) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, GroundPose{way, 0.0}.in_space());
  return clip;
}

}  // namespace retarget
