#include "judge/quality/body_tracks.h"
#include "retarget/contact_plan.h"

namespace retarget {

std::vector<SoleContacts> sole_contacts(const RobotClip& clip) {
  std::vector<SoleContacts> contacts;
  for (const SoleTrack& track : track_soles(clip)) {
    SoleContacts& found = contacts.emplace_back(SoleContacts{track.sole, {}});
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      if (!track.stands(frame, clip.rate().fps())) continue;
      if (found.phases.empty() || found.phases.back().end != frame) {
        found.phases.push_back({frame, frame, 0.0});
      }
      ++found.phases.back().end;
    }
  }
  return contacts;
}

}  // namespace retarget
