#include "edit/seam_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/base/number_text.h"
#include "retarget/edit/pose_distance.h"
#include "retarget/math/statistics.h"

namespace retarget {
namespace {

// clips that stand still have no speed of their own, m/s
constexpr double kSlow = 0.25;

// of a bone from a frame to the next
double speed_of(const HumanClip& human, int frame, int bone) {
  const Eigen::Vector3d step =
      human.frame(frame + 1)[bone].translation - human.frame(frame)[bone].translation;
  return step.norm() * human.rate.fps();
}

double speed_percentile(std::vector<double> speeds) {
  return speeds.empty() ? 0.0 : percentile(std::move(speeds), 99.9);
}

std::vector<double> speeds_of(const HumanClip& a, const HumanClip& b, int bone) {
  std::vector<double> speeds;
  for (const HumanClip* human : {&a, &b}) {
    for (int frame = 0; frame + 1 < human->frame_count; ++frame) {
      speeds.push_back(speed_of(*human, frame, bone));
    }
  }
  return speeds;
}

// the way of an ankle from a frame to the next; nothing where the clip has none
Eigen::Vector3d step_at(const std::vector<Pose>& ankles, int frame) {
  if (frame < 0 || frame + 1 >= static_cast<int>(ankles.size())) return Eigen::Vector3d::Zero();
  const auto at = static_cast<std::size_t>(frame);
  return ankles[at + 1].translation - ankles[at].translation;
}

}  // namespace

SeamCheck check_speeds(const HumanClip& a, const HumanClip& b, const HumanClip& joined,
                       const SeamRegion& region, double speed_factor) {
  const std::vector<int> bones = common_bones(a, b);
  std::vector<std::vector<double>> own;
  std::vector<double> all;
  for (const int bone : bones) {
    own.push_back(speeds_of(a, b, bone));
    all.insert(all.end(), own.back().begin(), own.back().end());
  }
  const double usual_of_all = speed_percentile(std::move(all));

  SeamCheck check;
  double largest_share = -1.0;
  const int end = std::min(region.end + 1, joined.frame_count - 1);
  for (std::size_t k = 0; k < bones.size(); ++k) {
    const double usual =
        std::max(kSlow, std::min(usual_of_all, speed_percentile(std::move(own[k]))));
    for (int frame = std::max(region.begin - 1, 0); frame < end; ++frame) {
      const double speed = speed_of(joined, frame, bones[k]);
      if (speed <= largest_share * usual) continue;
      largest_share = speed / usual;
      check.usual_speed = usual;
      check.largest_speed = speed;
      check.fastest_bone = kBoneNames[static_cast<std::size_t>(bones[k])];
    }
  }
  if (largest_share > speed_factor) {
    check.faults.push_back(check.fastest_bone + " moves at " + number_text(check.largest_speed, 2) +
                           " m/s, above " + number_text(speed_factor, 1) +
                           " times the clips' own " + number_text(check.usual_speed, 2));
  }
  return check;
}

void check_feet(SeamCheck& check, const ClipFeet& a, const ClipFeet& b, const ClipFeet& joined,
                const std::vector<PlantedFoot>& plants, const SeamRegion& region,
                const FrameRate& rate) {
  std::vector<double> speeds, own_speeds;
  for (const PlantedFoot& plant : plants) {
    const auto& ankles = joined.ankles[plant.foot];
    const int last = std::min({plant.end() - 1, region.end, static_cast<int>(ankles.size()) - 1});
    for (int frame = std::max({plant.begin, region.begin - 1, 0}); frame < last; ++frame) {
      const Eigen::Vector3d step = step_at(ankles, frame);
      const Eigen::Vector3d in_a = step_at(a.ankles[plant.foot], frame),
                            in_b = step_at(b.ankles[plant.foot], frame - region.b_shift);
      check.jump =
          std::max(check.jump, (step.norm() - std::max(in_a.norm(), in_b.norm())) * rate.fps());
      if (frame < region.begin) continue;
      speeds.push_back(step.head<2>().norm() * rate.fps());
      own_speeds.push_back(std::max(in_a.head<2>().norm(), in_b.head<2>().norm()) * rate.fps());
    }
  }
  check.slip = speeds.empty() ? 0.0 : mean(speeds);
  check.own_slip = own_speeds.empty() ? 0.0 : mean(own_speeds);
}

void find_faults(SeamCheck& check, const Seam& seam, const ConcatenateOptions& options) {
  if (seam.distance > options.threshold) {
    check.faults.insert(
        check.faults.begin(),
        "the poses are " + number_text(100.0 * seam.distance, 1) + " cm apart, more than " +
            number_text(100.0 * options.threshold, 1) +
            (seam.worst_bone.empty() ? std::string()
                                     : " (" + seam.worst_bone + " by " +
                                           number_text(100.0 * seam.worst_distance, 1) + " cm)"));
  }
  if (check.slip > check.own_slip + options.slip) {
    check.faults.push_back("planted feet slip at " + number_text(check.slip, 3) +
                           " m/s, in the clips at " + number_text(check.own_slip, 3));
  }
  if (check.jump > options.jump) {
    check.faults.push_back("a planted foot jumps at " + number_text(check.jump, 2) +
                           " m/s, more than " + number_text(options.jump, 2));
  }
}

}  // namespace retarget
