#include "edit/seam.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "edit/plant_feet.h"
#include "edit/seam_blend.h"
#include "retarget/clip.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// Contacts separated by less than this are merged, seconds.
constexpr double kSameStand = 0.1;

class FootJoiner {
 public:
  FootJoiner(const std::vector<Pose>& a, const std::vector<Pose>& b, const SeamRegion& region)
      : a_(a), b_(b), region_(region) {}

  // Returns the pose of b in a frame of the result.
  [[nodiscard]] const Pose& of_b(int frame) const {
    return b_[static_cast<std::size_t>(frame - region_.b_shift)];
  }

  [[nodiscard]] PlantedFoot from_a(const ContactPhase& phase) const {
    return {0, phase.begin, {a_.begin() + phase.begin, a_.begin() + phase.end}};
  }

  [[nodiscard]] PlantedFoot from_b(const ContactPhase& phase) const {
    return {0, phase.begin, {&of_b(phase.begin), &of_b(phase.begin) + (phase.end - phase.begin)}};
  }

  // Returns the plant of a foot that stands in both clips: it keeps a's ground position; height and
  // tilt blend from a to b.
  [[nodiscard]] PlantedFoot from_both(const ContactPhase& in_a, const ContactPhase& in_b) const {
    // Clip b must take over by a's last frame, even if its foot is not down yet.
    const int last = static_cast<int>(a_.size()) - 1;
    const int change = std::clamp(in_b.begin, region_.begin, last);
    const int middle = (std::max(in_a.begin, in_b.begin) + std::min(in_a.end, in_b.end)) / 2;
    // Compare in a frame that both clips have.
    const int both = std::clamp(middle, region_.begin, last);
    const Pose a_from_b = between_places(of_b(both), a_[both]).in_space();

    const Pose first = a_from_b * of_b(change);
    const Eigen::Vector3d shift = a_[change].translation - first.translation;
    const Eigen::Vector3d turn = log_so3(a_[change].rotation * first.rotation.conjugate());
    const Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();
    const double frames = std::max(region_.end - region_.begin, 1);
    PlantedFoot plant = from_a({in_a.begin, std::max(in_a.begin, std::min(change, in_b.end))});
    for (int frame = plant.end(); frame < in_b.end; ++frame) {
      Pose pose = a_from_b * of_b(frame);
      pose.translation += fade(shift, at_rest, frames, frame - change);
      pose.rotation =
          (exp_so3(fade(turn, at_rest, frames, frame - change)) * pose.rotation).normalized();
      plant.world_from_foot.push_back(pose);
    }
    return plant;
  }

 private:
  const std::vector<Pose>& a_;
  const std::vector<Pose>& b_;
  const SeamRegion& region_;
};

std::vector<ContactPhase> clipped(const std::vector<ContactPhase>& phases, int shift, int begin,
                                  int end) {
  std::vector<ContactPhase> result;
  for (const ContactPhase& phase : phases) {
    const ContactPhase part{std::max(phase.begin + shift, begin), std::min(phase.end + shift, end)};
    if (part.begin < part.end) result.push_back(part);
  }
  return result;
}

}  // namespace

GroundPose between_places(const Pose& from, const Pose& to) {
  GroundPose result;
  result.heading = heading_of(to.rotation * from.rotation.conjugate()).value_or(0.0);
  result.position = to.translation.head<2>() - result * Eigen::Vector2d(from.translation.head<2>());
  return result;
}

std::vector<PlantedFoot> joined_plants(const ClipFeet& a, const ClipFeet& b,
                                       const ClipFeet& blended, const SeamRegion& region,
                                       const FrameRate& rate) {
  std::vector<PlantedFoot> plants;
  const int a_end = std::max(region.a_end, region.b_begin);
  for (int foot = 0; foot < 2; ++foot) {
    if (a.ankles[foot].empty() || b.ankles[foot].empty()) continue;
    const int end = static_cast<int>(b.ankles[foot].size()) + region.b_shift;
    auto of_a =
        clipped(without_short_breaks(a.contacts.phases[foot], kSameStand, rate), 0, 0, a_end);
    auto of_b = clipped(without_short_breaks(b.contacts.phases[foot], kSameStand, rate),
                        region.b_shift, region.b_begin, end);
    const FootJoiner joiner(a.ankles[foot], b.ankles[foot], region);
    const std::size_t first_new = plants.size();
    const bool near_seam = !of_a.empty() && of_a.back().end >= region.begin;
    const auto near = static_cast<int>(std::lround(kSameStand * rate.fps()));
    if (near_seam && !of_b.empty() && of_b.front().begin <= of_a.back().end + near &&
        of_b.front().end > of_a.back().begin) {
      const ContactPhase in_a = of_a.back(), in_b = of_b.front();
      of_a.pop_back();
      of_b.erase(of_b.begin());
      for (const ContactPhase& phase : of_a) plants.push_back(joiner.from_a(phase));
      plants.push_back(joiner.from_both(in_a, in_b));
    } else {
      // During the blend, a foot that stands in one clip follows that clip for half of the overlap.
      const int middle = (region.b_begin + a_end) / 2;
      const auto rises = [&](int frame, const Pose& stands) {
        const Pose& is = blended.ankles[foot][static_cast<std::size_t>(frame)];
        constexpr double kLifted = 0.02;
        return std::abs(is.translation.z() - stands.translation.z()) > kLifted;
      };
      int leaves = region.begin, comes = middle;
      while (leaves < middle && !rises(leaves, a.ankles[foot][static_cast<std::size_t>(leaves)]))
        ++leaves;
      while (comes < region.end && rises(comes, joiner.of_b(comes))) ++comes;
      for (const ContactPhase& phase : clipped(of_a, 0, 0, std::min(leaves, a_end))) {
        plants.push_back(joiner.from_a(phase));
      }
      of_b = clipped(of_b, 0, comes, end);
    }
    for (const ContactPhase& phase : of_b) plants.push_back(joiner.from_b(phase));
    for (std::size_t i = first_new; i < plants.size(); ++i) plants[i].foot = foot;
  }
  return plants;
}

}  // namespace retarget
