#include "edit/seam_feet.h"

#include <algorithm>
#include <cmath>

#include "edit/fading_offset.h"
#include "retarget/edit/ground_pose.h"
#include "retarget/math/so3.h"
#include "retarget/math/trigonometry.h"

namespace retarget {
namespace {

// two contacts nearer in time than this are one, seconds
constexpr double kSameStand = 0.1;

// what a foot's pose lacks to another
struct Gap {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = shift;  // metres, rotation vector

  static Gap between(const Pose& from, const Pose& to) {
    return {to.translation - from.translation, log_so3(to.rotation * from.rotation.conjugate())};
  }

  friend Gap operator-(const Gap& a, const Gap& b) { return {a.shift - b.shift, a.turn - b.turn}; }
};

class FootJoiner {
 public:
  FootJoiner(const std::vector<Pose>& a, const std::vector<Pose>& b, const SeamRegion& region)
      : a_(a), b_(b), region_(region) {}

  // b's pose in a frame of the result
  [[nodiscard]] const Pose& of_b(int frame) const {
    return b_[static_cast<std::size_t>(frame - region_.b_shift)];
  }

  [[nodiscard]] PlantedFoot from_a(const ContactPhase& phase) const {
    PlantedFoot plant{0, phase.begin, {}};
    for (int frame = phase.begin; frame < phase.end; ++frame) {
      plant.world_from_foot.push_back(a_[frame]);
    }
    return plant;
  }

  [[nodiscard]] PlantedFoot from_b(const ContactPhase& phase) const {
    PlantedFoot plant{0, phase.begin, {}};
    for (int frame = phase.begin; frame < phase.end; ++frame) {
      plant.world_from_foot.push_back(of_b(frame));
    }
    return plant;
  }

  // a foot that stands in both: over the ground it stays where a has it, height and tilt go over
  // from a's to b's
  [[nodiscard]] PlantedFoot from_both(const ContactPhase& in_a, const ContactPhase& in_b) const {
    const int frames_of_a = static_cast<int>(a_.size());
    // a's last pose that stands; a foot that b puts down later is held there
    const int held = std::min(std::max(in_a.end - 1, region_.begin), frames_of_a - 1);
    const int change = std::max(region_.begin, in_b.begin);
    const int middle = (std::max(in_a.begin, in_b.begin) + std::min(in_a.end, in_b.end)) / 2;
    const int of_a = std::clamp(middle, in_a.begin, held);
    const int of_b_too = std::clamp(middle, in_b.begin, in_b.end - 1);
    const Pose a_from_b = between_places(of_b(of_b_too), a_[of_a]).in_space();

    const auto as_a = [&](int frame) -> const Pose& { return a_[std::min(frame, held)]; };
    const auto as_b = [&](int frame) { return a_from_b * of_b(frame); };
    const auto lacks = [&](int frame) { return Gap::between(as_b(frame), as_a(frame)); };
    const Gap gap = lacks(change);
    // per frame; b's pose before its contact is that of a foot in the air
    Gap velocity;
    if (change > in_b.begin && change <= held) velocity = gap - lacks(change - 1);
    const double frames = std::max(region_.end - region_.begin, 1);
    PlantedFoot plant{0, in_a.begin, {}};
    for (int frame = in_a.begin; frame < in_b.end; ++frame) {
      if (frame < change) {
        plant.world_from_foot.push_back(as_a(frame));
        continue;
      }
      Pose pose = as_b(frame);
      pose.translation += fade(gap.shift, velocity.shift, frames, frame - change);
      pose.rotation =
          (exp_so3(fade(gap.turn, velocity.turn, frames, frame - change)) * pose.rotation)
              .normalized();
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
  const Eigen::Quaterniond turn = to.rotation * from.rotation.conjugate();
  GroundPose result;
  if (turn.z() * turn.z() + turn.w() * turn.w() > 1e-6) {
    result.heading = 2.0 * portable::atan2(turn.z(), turn.w());
  }
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
    if (near_seam && !of_b.empty() && of_b.front().begin <= of_a.back().end + near) {
      const ContactPhase in_a = of_a.back(), in_b = of_b.front();
      of_a.pop_back();
      of_b.erase(of_b.begin());
      for (const ContactPhase& phase : of_a) plants.push_back(joiner.from_a(phase));
      plants.push_back(joiner.from_both(in_a, in_b));
    } else {
      // while both count, a foot that stands in one alone is half its own
      const int middle = (region.b_begin + a_end) / 2;
      const auto rises = [&](int frame, const Pose& stands) {
        const Pose& is = blended.ankles[foot][static_cast<std::size_t>(frame)];
        constexpr double kLifted = 0.02;
        return std::abs(is.translation.z() - stands.translation.z()) > kLifted;
      };
      int leaves = region.begin, comes = middle;
      while (leaves < middle && !rises(leaves, a.ankles[foot][static_cast<std::size_t>(leaves)])) ++leaves;
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
