#include "edit/seam.h"

#include <utility>

#include "base/try.h"
#include "human/contact_plan.h"

namespace retarget {
namespace {

ClipFeet feet_of(const Clip& clip, const HumanMapping& mapping, const HumanClip& human) {
  ClipFeet feet;
  feet.contacts = find_contacts(human);
  const auto legs = find_legs(clip.skeleton(), mapping);
  for (int foot = 0; foot < 2; ++foot) {
    if (legs[foot]) feet.ankles[foot] = ankle_poses(clip, mapping, *legs[foot]);
  }
  return feet;
}

}  // namespace

HumanMotion::HumanMotion(const Clip& of, const HumanMapping& mapping)
    : clip(of), human(to_human(of, mapping)), feet(feet_of(of, mapping, human)) {}

Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b, const Seam& seam,
                               const HumanMapping& mapping, const BodyMover& mover,
                               const ConcatenateOptions& options) {
  const FrameRate& rate = a.clip.rate();
  const SeamRegion region = seam_region(seam, options, rate, b.clip.frame_count());
  Clip joined = blend_clips(a.clip, b.clip, region, mapping, mover);
  const ClipFeet blended = feet_of(joined, mapping, to_human(joined, mapping));
  const auto plants = joined_plants(a.feet, b.feet, blended, region, rate);
  TRY(plant_feet(joined, mapping, plants, options.plant));

  const HumanMotion result(joined, mapping);
  SeamCheck check = check_motion(a.human, b.human, result.human, region, options.limits);
  check_feet(check, a.feet, b.feet, result.feet, plants, region, rate);
  find_faults(check, seam, options);
  return JoinedClips{std::move(joined), std::move(check)};
}

}  // namespace retarget
