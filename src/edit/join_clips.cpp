#include "edit/seam.h"

#include <utility>

#include "base/try.h"
#include "edit/ground_pose.h"
#include "human/gait/contact_plan.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/human.h"

namespace retarget {
namespace {

ClipFeet feet_of(const Clip& clip, const Calibration& calibration, const HumanClip& human) {
  ClipFeet feet;
  feet.contacts = find_contacts(human);
  const auto legs = find_legs(clip.skeleton(), calibration);
  for (int foot = 0; foot < 2; ++foot) {
    if (legs[foot]) feet.ankles[foot] = ankle_poses(clip, calibration, *legs[foot]);
  }
  return feet;
}

}  // namespace

HumanMotion::HumanMotion(const Clip& of, const Calibration& calibration)
    : clip(of), human(to_human(of, calibration)), feet(feet_of(of, calibration, human)) {}

Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b, const Seam& seam,
                               const Calibration& calibration, const BodyMover& mover,
                               const ConcatenateOptions& options) {
  const FrameRate& rate = a.clip.rate();
  const SeamRegion region = seam_region(seam, options, rate, b.clip.frame_count());
  Clip joined = blend_clips(a.clip, b.clip, region, calibration, mover);
  const ClipFeet blended = feet_of(joined, calibration, to_human(joined, calibration));
  const auto plants = joined_plants(a.feet, b.feet, blended, region, rate);
  TRY(plant_feet(joined, calibration, plants, options.plant));

  const HumanMotion result(joined, calibration);
  SeamCheck check = check_motion(a.human, b.human, result.human, region, options.limits);
  check_feet(check, a.feet, b.feet, result.feet, plants, region, rate);
  find_faults(check, seam, options);
  return JoinedClips{std::move(joined), std::move(check)};
}

}  // namespace retarget
