#include "human/foot_contacts.h"

#include "math/statistics.h"

namespace retarget {
namespace {

struct FootBones {
  int hip, knee, ankle, toe;
};

std::array<FootBones, 2> bones_of_feet() {
  const auto bone = [](const char* name) { return *find_bone(name); };
  return {{{bone("LeftUpLeg"), bone("LeftLeg"), bone("LeftFoot"), bone("LeftToe")},
           {bone("RightUpLeg"), bone("RightLeg"), bone("RightFoot"), bone("RightToe")}}};
}

std::vector<Eigen::Vector3d> track_of(const HumanClip& human, int bone) {
  std::vector<Eigen::Vector3d> track;
  if (!human.has(bone)) return track;
  track.reserve(human.frame_count);
  for (int i = 0; i < human.frame_count; ++i) track.push_back(human.frame(i)[bone].translation);
  return track;
}

}  // namespace

double leg_length(const HumanClip& human) {
  if (human.frame_count == 0) return 0.0;
  for (const FootBones& side : bones_of_feet()) {
    if (!human.has(side.hip) || !human.has(side.knee) || !human.has(side.ankle)) continue;
    std::vector<double> lengths;
    lengths.reserve(human.frame_count);
    for (int i = 0; i < human.frame_count; ++i) {
      const auto pose = human.frame(i);
      lengths.push_back((pose[side.hip].translation - pose[side.knee].translation).norm() +
                        (pose[side.knee].translation - pose[side.ankle].translation).norm());
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
    feet[foot].ankle = track_of(human, bones_of_feet()[foot].ankle);
    // a toe without its ankle says nothing of a foot
    if (!feet[foot].ankle.empty()) feet[foot].toe = track_of(human, bones_of_feet()[foot].toe);
  }
  return find_contact_phases(feet, leg, human.rate, options);
}

}  // namespace retarget
