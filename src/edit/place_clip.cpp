// Edits of position: floor height, rotation, translation.

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/math/statistics.h"
#include "base/option_name.h"
#include "base/try.h"
#include "edit/ground_pose.h"
#include "human/gait/contact_plan.h"
#include "motion/skeleton_points.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/text.h"

namespace retarget {

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
                         OPTION("floor") " H sets the floor height in metres");
  }
  return median(std::move(heights));
}

Result<Clip> put_on_floor(Clip clip, const Calibration& calibration, double floor) {
  TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, {Eigen::Quaterniond::Identity(), {0.0, 0.0, -floor}});
  return clip;
}

Result<Clip> turn_clip(Clip clip, const Calibration& calibration, double angle) {
  TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
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
  TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, GroundPose{way, 0.0}.in_space());
  return clip;
}

}  // namespace retarget
