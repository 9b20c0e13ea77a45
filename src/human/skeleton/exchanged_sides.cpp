#include "human/skeleton/exchanged_sides.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"

namespace retarget {
namespace {

using enum LimbBone;
using Eigen::Vector3d;

bool has_legs_and_shoulders(const JointTree& tree) {
  return std::ranges::all_of(kSides, [&](Side side) {
    return std::ranges::all_of(std::array{kUpLeg, kLeg, kFoot, kArm}, [&](LimbBone part) {
      return tree.joint_of_bone[side_bone(side, part)] >= 0;
    });
  });
}

}  // namespace

double facing_by(const JointTree& tree, LimbBone part) {
  const auto place = [&](Bone bone, int frame) -> const Vector3d& {
    return tree.tracks[tree.joint_of_bone[bone]][frame];
  };
  const int frames = tree.frame_count(), step = std::max(1, frames / 200);
  double sum = 0.0;
  int count = 0;
  for (int frame = 0; frame < frames; frame += step) {
    const Vector3d across =
        place(side_bone(Side::kLeft, part), frame) - place(side_bone(Side::kRight, part), frame);
    const Vector3d shoulders = 0.5 * (place(Bone::kLeftArm, frame) + place(Bone::kRightArm, frame));
    const Vector3d front = across.cross(shoulders - place(Bone::kHips, frame)).normalized();
    for (const Side side : kSides) {
      const Vector3d& hip = place(side_bone(side, kUpLeg), frame);
      const Vector3d& knee = place(side_bone(side, kLeg), frame);
      const Vector3d& ankle = place(side_bone(side, kFoot), frame);
      const int toe = tree.joint_of_bone[side_bone(side, kToe)];
      const Vector3d foot =
          toe >= 0 ? Vector3d(tree.tracks[toe][frame] - ankle) : Vector3d(Vector3d::Zero());
      sum += leg_facing(knee - hip, ankle - knee, foot, front);
      ++count;
    }
  }
  return sum / count;
}

bool sides_are_exchanged(const JointTree& tree) {
  return has_legs_and_shoulders(tree) && facing_by(tree, kUpLeg) < -kMinSwapEvidence &&
         facing_by(tree, kArm) < -kMinSwapEvidence;
}

JointMotion with_exchanged_sides(JointMotion motion) {
  const std::vector<JointName> names = normalise_joint_names(motion.names);
  for (std::size_t left = 0; left < names.size(); ++left) {
    if (names[left].side != Side::kLeft) continue;
    const auto right = std::ranges::find(names, JointName{Side::kRight, names[left].base});
    if (right == names.end()) continue;
    for (int frame = 0; frame < motion.frame_count; ++frame) {
      const std::size_t first = motion.index(frame, 0);
      std::swap(motion.positions[first + left],
                motion.positions[first + static_cast<std::size_t>(right - names.begin())]);
    }
  }
  return motion;
}

}  // namespace retarget
