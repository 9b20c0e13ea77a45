#include "human/foot_contacts.h"

#include "math/statistics.h"

namespace retarget {
namespace {

std::vector<Eigen::Vector3d> track_of(const HumanClip& human, Bone bone) {
  std::vector<Eigen::Vector3d> track;
  if (!human.has(bone)) return track;
  track.reserve(human.frame_count);
  for (int i = 0; i < human.frame_count; ++i) track.push_back(human.frame(i)[bone].translation);
  return track;
}

}  // namespace

double leg_length(const HumanClip& human) {
  if (human.frame_count == 0) return 0.0;
  for (const Side side : kSides) {
    const Bone hip = side_bone(side, LimbBone::kUpLeg), knee = side_bone(side, LimbBone::kLeg);
    const Bone ankle = side_bone(side, LimbBone::kFoot);
    if (!human.has(hip) || !human.has(knee) || !human.has(ankle)) continue;
    std::vector<double> lengths;
    lengths.reserve(human.frame_count);
    for (int i = 0; i < human.frame_count; ++i) {
      const HumanPose& pose = human.frame(i);
      lengths.push_back((pose[hip].translation - pose[knee].translation).norm() +
                        (pose[knee].translation - pose[ankle].translation).norm());
    }
    return median(std::move(lengths));
  }
  return 0.0;
}

FootContacts find_foot_contacts(const HumanClip& human, const ContactOptions& options) {
  const double leg = leg_length(human);
  if (!(leg > 0.0)) return {};
  std::array<FootTrack, 2> feet;
  for (int foot = 0; foot < 2; ++foot) {
    feet[foot].ankle = track_of(human, side_bone(kSides[foot], LimbBone::kFoot));
    // a toe without its ankle says nothing of a foot
    if (feet[foot].ankle.empty()) continue;
    feet[foot].toe = track_of(human, side_bone(kSides[foot], LimbBone::kToe));
  }
  return find_contact_phases(feet, leg, human.rate, options);
}

}  // namespace retarget
