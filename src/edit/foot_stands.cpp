#include "edit/foot_stands.h"

#include "human/gait/contact_plan.h"

namespace retarget {

std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human, double same_stand) {
  std::array<std::vector<FootStand>, 2> stands;
  const ContactPlan contacts = find_contacts(human);
  const double upright_rise = kUprightRise * contacts.scale;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone ankle = side_bone(kSides[foot], LimbBone::kFoot),
               toe = side_bone(kSides[foot], LimbBone::kToe);
    if (!human.has(ankle)) continue;
    const bool has_toe = human.has(toe);
    std::vector<FootStance> stances(static_cast<std::size_t>(human.frame_count),
                                    FootStance::kOnSole);
    std::vector<ContactPhase> phases;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      if (!contacts.in_contact(foot, frame)) {
        if (!has_toe) continue;
        const HumanPose& pose = human.frame(frame);
        const double rise = pose[ankle].translation.z() - pose[toe].translation.z();
        if (contacts.in_contact(foot, kHeelEnd, frame)) {
          stances[frame] = FootStance::kOnHeel;
        } else if (contacts.in_contact(foot, kToeEnd, frame) && rise > upright_rise) {
          stances[frame] = FootStance::kOnToes;
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

PlantedFoot plant_of(const FootStand& stand, int foot, int frame, const std::vector<Pose>& ankles,
                     const HumanClip& human) {
  PlantedFoot plant{
      foot, stand.begin, {ankles.begin() + stand.begin, ankles.begin() + stand.end}, stand.stances};
  const Bone toe = side_bone(kSides[foot], LimbBone::kToe);
  if (human.has(toe)) {
    plant.toes_in_foot = ankles[frame].inverse() * human.frame(frame)[toe].translation;
  }
  return plant;
}

}  // namespace retarget
