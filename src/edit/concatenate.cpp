#include "retarget/edit/concatenate.h"

#include <algorithm>
#include <utility>

#include "edit/seam_blend.h"
#include "edit/seam_feet.h"
#include "retarget/base/number_text.h"
#include "retarget/base/suggest.h"
#include "retarget/edit/pose_distance.h"
#include "retarget/human/foot_contacts.h"
#include "retarget/math/statistics.h"

namespace retarget {
namespace {

// of a bone from a frame to the next
double speed_of(const HumanClip& human, int frame, int bone) {
  const Eigen::Vector3d step =
      human.frame(frame + 1)[bone].translation - human.frame(frame)[bone].translation;
  return step.norm() * human.rate.fps();
}

std::vector<double> all_speeds(const HumanClip& a, const HumanClip& b) {
  std::vector<double> speeds;
  for (const HumanClip* human : {&a, &b}) {
    const std::vector<int> bones = common_bones(*human, *human);
    for (int frame = 0; frame + 1 < human->frame_count; ++frame) {
      for (const int bone : bones) speeds.push_back(speed_of(*human, frame, bone));
    }
  }
  return speeds;
}

ClipFeet feet_of(const Clip& clip, const HumanMapping& mapping, const HumanClip& human) {
  ClipFeet feet;
  feet.contacts = find_foot_contacts(human);
  const auto legs = find_legs(clip.skeleton(), mapping);
  for (int foot = 0; foot < 2; ++foot) {
    if (legs[foot]) feet.ankles[foot] = ankle_poses(clip, mapping, *legs[foot]);
  }
  return feet;
}

// mean speed over the floor of the ankles that are planted in a region
double slip_of(const Clip& clip, const HumanMapping& mapping,
               const std::vector<PlantedFoot>& plants, const SeamRegion& region) {
  const auto legs = find_legs(clip.skeleton(), mapping);
  const int end = std::min(region.end + 1, clip.frame_count());
  const Clip part = cut(clip, region.begin, end);
  std::vector<double> speeds;
  for (int foot = 0; foot < 2; ++foot) {
    if (!legs[foot]) continue;
    const auto ankles = ankle_poses(part, mapping, *legs[foot]);
    for (const PlantedFoot& plant : plants) {
      if (plant.foot != foot) continue;
      const int last = std::min(plant.end(), end) - 1;
      for (int frame = std::max(plant.begin, region.begin); frame < last; ++frame) {
        const auto at = static_cast<std::size_t>(frame - region.begin);
        const Eigen::Vector3d step = ankles[at + 1].translation - ankles[at].translation;
        speeds.push_back(step.head<2>().norm() * clip.rate().fps());
      }
    }
  }
  return speeds.empty() ? 0.0 : mean(speeds);
}

SeamCheck check_speeds(const HumanClip& joined, std::vector<double> usual,
                       const SeamRegion& region) {
  SeamCheck check;
  if (!usual.empty()) check.usual_speed = percentile(std::move(usual), 99.9);
  const std::vector<int> bones = common_bones(joined, joined);
  const int end = std::min(region.end + 1, joined.frame_count - 1);
  for (int frame = std::max(region.begin - 1, 0); frame < end; ++frame) {
    for (const int bone : bones) {
      const double speed = speed_of(joined, frame, bone);
      if (speed <= check.largest_speed) continue;
      check.largest_speed = speed;
      check.fastest_bone = kBoneNames[static_cast<std::size_t>(bone)];
    }
  }
  return check;
}

void find_faults(SeamCheck& check, const Seam& seam, const ConcatenateOptions& options) {
  if (seam.distance > options.threshold) {
    check.faults.push_back("the poses are " + number_text(100.0 * seam.distance, 1) +
                           " cm apart, more than " + number_text(100.0 * options.threshold, 1) +
                           " (" + seam.worst_bone + " by " +
                           number_text(100.0 * seam.worst_distance, 1) + " cm)");
  }
  // clips that stand still have no speed of their own
  constexpr double kSlow = 0.1;
  if (check.largest_speed > options.speed_factor * std::max(check.usual_speed, kSlow)) {
    check.faults.push_back(check.fastest_bone + " moves at " + number_text(check.largest_speed, 2) +
                           " m/s, above " + number_text(options.speed_factor, 1) +
                           " times the clips' own " + number_text(check.usual_speed, 2));
  }
  if (check.slip > options.slip) {
    check.faults.push_back("planted feet slip at " + number_text(check.slip, 3) +
                           " m/s, more than " + number_text(options.slip, 3));
  }
}

}  // namespace

Result<Concatenation> concatenate(const Clip& a, const Clip& b, const HumanMapping& mapping,
                                  const ConcatenateOptions& options, const std::string& a_file,
                                  const std::string& b_file) {
  if (!same_rate(a.rate(), b.rate())) {
    return input_failure(b_file, "has " + to_text(b.rate()) + " frames per second, " + a_file +
                                     " " + to_text(a.rate()));
  }
  if (a.skeleton().names() != b.skeleton().names() ||
      a.skeleton().translated_count() != b.skeleton().translated_count()) {
    return input_failure(b_file, "has another skeleton than " + a_file);
  }
  const auto mover = BodyMover::of(a.skeleton(), mapping, a_file);
  if (!mover) return failure(mover.error());
  const HumanClip human_a = to_human(a, mapping);
  auto search = find_seam(human_a, to_human(b, mapping), options.seam, a_file, b_file);
  if (!search) return failure(search.error());
  const Seam& seam = search->seam;

  Clip moved = b;
  mover->move_all(moved, seam.a_from_b.in_space());
  const HumanClip human_b = to_human(moved, mapping);
  const SeamRegion region = seam_region(seam, options, a.rate(), b.frame_count());
  Clip joined = blend_clips(a, moved, region);
  const auto plants = joined_plants(feet_of(a, mapping, human_a), feet_of(moved, mapping, human_b),
                                    region, a.rate());
  const auto planted = plant_feet(joined, mapping, plants, options.plant, a_file);
  if (!planted) return failure(planted.error());

  SeamCheck check = check_speeds(to_human(joined, mapping), all_speeds(human_a, human_b), region);
  check.slip = slip_of(joined, mapping, plants, region);
  find_faults(check, seam, options);
  if (!check.faults.empty() && !options.force) {
    return run_failure(b_file, "does not fit to " + a_file + ": " + list_names(check.faults),
                       "--force joins them all the same; --search all looks at the whole clips");
  }
  return Concatenation{std::move(joined), seam, std::move(search->map), std::move(check)};
}

}  // namespace retarget
