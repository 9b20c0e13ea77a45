#include "edit/put_on_floor.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/option_name.h"
#include "edit/ground_pose.h"
#include "human/foot_contacts.h"
#include "math/statistics.h"
#include "motion/forward_kinematics.h"
#include "motion/skeleton_points.h"

namespace retarget {
Result<double> floor_height(const Clip& clip, const HumanMapping& mapping,
                            const std::string& file) {
  const Skeleton& skeleton = clip.skeleton();
  // who is there for less than a contact stands if still
  ContactOptions standing;
  standing.shortest = std::min(standing.shortest, clip.frame_count() * clip.rate().frame_time());
  const FootContacts contacts = find_foot_contacts(to_human(clip, mapping), standing);
  std::array<std::vector<SkeletonPoint>, 2> feet;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = side_bone(kSides[foot], LimbBone::kFoot);
    feet[foot] = points_below(skeleton, mapping.bones[bone].position_joint);
  }
  const Eigen::RowVector3d up = mapping.human_from_source.row(2) * mapping.metres_per_unit;
  std::vector<double> heights;
  std::vector<Pose> poses(static_cast<std::size_t>(skeleton.joint_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    for (int foot = 0; foot < 2; ++foot) {
      if (!contacts.planted(foot, frame)) continue;
      double lowest = std::numeric_limits<double>::infinity();
      for (const SkeletonPoint& point : feet[foot]) {
        lowest = std::min(lowest, up.dot(world_from_point(point, poses).translation));
      }
      heights.push_back(lowest);
    }
  }
  if (heights.empty()) {
    return input_failure(file, "no foot ever stands: the floor cannot be told",
                         OPTION("floor") " H says how high the floor is, in metres");
  }
  return median(std::move(heights));
}

Result<Clip> put_on_floor(Clip clip, const HumanMapping& mapping, double floor,
                          const std::string& file) {
  const auto mover = BodyMover::of(clip, mapping, file);
  if (!mover) return failure(mover.error());
  mover->move_all(clip, {Eigen::Quaterniond::Identity(), {0.0, 0.0, -floor}});
  return clip;
}

}  // namespace retarget
