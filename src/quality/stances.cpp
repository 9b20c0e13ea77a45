#include "quality/stances.h"

#include <utility>
#include <vector>

#include "human/canonical_pose.h"

namespace retarget {
namespace {

constexpr double kSoleDown = 0.75;  // height of a foot's up vector

class FootSole {
 public:
  FootSole(const HumanClip& human, int foot)
      : human_(human),
        bone_(side_bone(kSides[foot], LimbBone::kFoot)),
        up_in_foot_(canonical_t_pose(bone_).transpose() * Eigen::Vector3d::UnitZ()) {}

  [[nodiscard]] bool is_down(int frame) const {
    return (human_.frame(frame)[bone_].rotation * up_in_foot_).z() > kSoleDown;
  }

 private:
  const HumanClip& human_;
  Bone bone_;
  Eigen::Vector3d up_in_foot_;
};

}  // namespace

FootContacts stances_of(const HumanClip& human, FootContacts contacts,
                        const ContactOptions& options) {
  for (int foot = 0; foot < 2; ++foot) {
    const FootSole sole(human, foot);
    std::vector<ContactPhase> kept;
    for (const ContactPhase& phase : contacts.phases[foot]) {
      for (int begin = phase.begin; begin < phase.end;) {
        int end = begin;
        while (end < phase.end && sole.is_down(end)) ++end;
        const bool long_enough = (end - begin) * human.rate.frame_time() > options.shortest - 1e-9;
        // a phase that is whole stays as it is
        const bool whole = begin == phase.begin && end == phase.end;
        if (end > begin && (long_enough || whole)) kept.push_back({begin, end});
        begin = end + 1;
      }
    }
    contacts.phases[foot] = std::move(kept);
  }
  return contacts;
}

}  // namespace retarget
