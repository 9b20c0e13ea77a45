#include "edit/foot_stands.h"

#include "human/foot_contacts.h"

namespace retarget {
namespace {

// contacts of one part of both feet with the floor, as if it were all of them
FootContacts contacts_of_part(const HumanClip& human, LimbBone part) {
  std::array<FootTrack, 2> parts;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = side_bone(kSides[foot], part);
    if (!human.has(bone)) continue;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      parts[foot].ankle.push_back(human.frame(frame)[bone].translation);
    }
  }
  return find_contact_phases(parts, leg_length(human), human.rate);
}

}  // namespace

std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human, double same_stand) {
  std::array<std::vector<FootStand>, 2> stands;
  if (!(leg_length(human) > 0.0)) return stands;
  const FootContacts soles = find_foot_contacts(human),
                     heels = contacts_of_part(human, LimbBone::kFoot),
                     toes = contacts_of_part(human, LimbBone::kToe);
  const double upright_rise = ContactOptions().upright_rise * soles.scale;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone ankle = side_bone(kSides[foot], LimbBone::kFoot),
               toe = side_bone(kSides[foot], LimbBone::kToe);
    if (!human.has(ankle)) continue;
    const bool has_toe = human.has(toe);
    std::vector<FootStance> stances(static_cast<std::size_t>(human.frame_count), FootStance::kSole);
    std::vector<ContactPhase> phases;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      if (!soles.planted(foot, frame)) {
        if (!has_toe) continue;
        const HumanPose& pose = human.frame(frame);
        const double rise = pose[ankle].translation.z() - pose[toe].translation.z();
        if (heels.planted(foot, frame)) {
          stances[frame] = FootStance::kHeel;
        } else if (toes.planted(foot, frame) && rise > upright_rise) {
          stances[frame] = FootStance::kToes;
        } else {
          continue;
        }
      }
      if (phases.empty() || phases.back().end != frame) phases.push_back({frame, frame});
      phases.back().end = frame + 1;
    }
    for (const ContactPhase& phase : without_short_breaks(phases, same_stand, human.rate)) {
      stands[foot].push_back(
          {phase.begin, phase.end, {stances.begin() + phase.begin, stances.begin() + phase.end}});
    }
  }
  return stands;
}

}  // namespace retarget
