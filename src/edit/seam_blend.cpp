#include "edit/seam.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/memory_clip.h"
#include "edit/plant_feet.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

// Blends values of two clips in the frames around their seam.
class SeamMixer {
 public:
  SeamMixer(const Clip& a, const Clip& b, const SeamRegion& region)
      : a_(a), b_(b), region_(region), crossfades_(region.a_end > region.b_begin) {
    const int at_a = region.begin, at_b = seam_in_b();
    // Compare steps at the same time: into the seam, or after it if a clip has no earlier frame.
    const int after = at_a > 0 && at_b > 0 ? 0 : 1;
    step_a_ = at_a + after;
    step_b_ = at_b + after;
    extrapolated_ = step_a_ >= a.frame_count();
    steps_ = step_b_ < b.frame_count() && (!extrapolated_ || at_a >= 2);
  }

  /// @param in  returns the value of a clip in a frame.
  template <typename Value>
  [[nodiscard]] Eigen::Quaterniond rotation(const Value& in, int frame) const {
    const Eigen::Quaterniond of_b = in(b_, frame - region_.b_shift);
    if (crossfades_) return interpolate_linear(in(a_, frame), of_b, weight_of_b(frame));
    const auto turn = [](const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
      return log_so3(to * from.conjugate());
    };
    const auto step = [&](const Clip& clip, int to) {
      return turn(in(clip, to - 1), in(clip, to));
    };
    const Eigen::Vector3d gap = turn(in(b_, seam_in_b()), in(a_, region_.begin));
    return (exp_so3(faded(gap, step, frame)) * of_b).normalized();
  }

  template <typename Value>
  [[nodiscard]] Eigen::Vector3d translation(const Value& in, int frame) const {
    const Eigen::Vector3d of_b = in(b_, frame - region_.b_shift);
    if (crossfades_) {
      const Eigen::Vector3d of_a = in(a_, frame);
      return of_a + weight_of_b(frame) * (of_b - of_a);
    }
    const auto step = [&](const Clip& clip, int to) -> Eigen::Vector3d {
      return in(clip, to) - in(clip, to - 1);
    };
    const Eigen::Vector3d gap = in(a_, region_.begin) - in(b_, seam_in_b());
    return of_b + faded(gap, step, frame);
  }

 private:
  [[nodiscard]] double weight_of_b(int frame) const { return 1.0 - region_.weight_of_a(frame); }
  [[nodiscard]] int seam_in_b() const { return region_.begin - region_.b_shift; }

  // Returns the offset that fades out over b: at the seam, b takes a's value and a's velocity.
  template <typename Step>
  [[nodiscard]] Eigen::Vector3d faded(const Eigen::Vector3d& gap, const Step& step,
                                      int frame) const {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    // If both clips have the same frame at the seam, b continues with its own velocity.
    constexpr double kSameFrame = 1e-7;
    if (steps_ && (!extrapolated_ || gap.norm() > kSameFrame)) {
      const int last = region_.begin;
      const Eigen::Vector3d of_a = extrapolated_
                                       ? Eigen::Vector3d(2.0 * step(a_, last) - step(a_, last - 1))
                                       : step(a_, step_a_);
      velocity = of_a - step(b_, step_b_);
    }
    return fade(gap, velocity, region_.end - region_.begin, frame - region_.begin);
  }

  const Clip& a_;
  const Clip& b_;
  const SeamRegion& region_;
  const bool crossfades_;
  int step_a_ = 0, step_b_ = 0;  // Frames at which the compared steps end.
  bool steps_ = false;           // True if both steps are known.
  bool extrapolated_ = false;    // True if a's step is extrapolated from its last two steps.
};

// Sets the world pose of the hips through their own channels, or through the joint that moves the
// body if these are not free.
void put_hips(Clip& clip, int frame, int hips, const Pose& world_from_hips,
              const Calibration& calibration, const BodyMover& mover) {
  const Skeleton& skeleton = clip.skeleton();
  if (moves_freely(skeleton.joint(hips))) {
    const Pose world_from_parent = world_from_joint(clip, frame, skeleton.joint(hips).parent);
    const Pose parent_from_hips = world_from_parent.inverse() * world_from_hips;
    clip.rotations(frame)[hips] = parent_from_hips.rotation.normalized();
    clip.translations(frame)[skeleton.translation_slot(hips)] = parent_from_hips.translation;
    return;
  }
  const Pose move = world_from_hips * world_from_joint(clip, frame, hips).inverse();
  const Eigen::Quaterniond human_from_source(calibration.human_from_source);
  mover.move(clip, frame,
             Pose{human_from_source * move.rotation * human_from_source.conjugate(),
                  human_from_source * move.translation * calibration.metres_per_unit});
}

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

double SeamRegion::weight_of_a(int frame) const {
  if (frame < b_begin) return 1.0;
  if (frame >= a_end) return 0.0;
  const double share = static_cast<double>(frame - begin + 1) / (end - begin);
  return share * share * (2.0 * share - 3.0) + 1.0;
}

SeamRegion seam_region(const Seam& seam, const ConcatenateOptions& options, const FrameRate& rate,
                       int frames_of_b) {
  SeamRegion region;
  region.begin = region.b_begin = seam.a_frame;
  region.b_shift = seam.a_frame - seam.b_frame;
  const bool whole = seam.overlap >= frames_in(options.seam.window, rate);
  if (options.blend == SeamBlend::kCrossfade && whole) {
    region.end = region.a_end = seam.a_frame + seam.overlap;
  } else {
    region.a_end = seam.a_frame;
    region.end =
        std::min(seam.a_frame + frames_in(options.fade, rate), frames_of_b + region.b_shift);
  }
  return region;
}

Clip blend_clips(const Clip& a, const Clip& b, const SeamRegion& region,
                 const Calibration& calibration, const BodyMover& mover) {
  Clip result = without_file_size(cut(a, 0, region.begin));
  result.resize(b.frame_count() + region.b_shift);
  for (int frame = region.begin; frame < result.frame_count(); ++frame) {
    copy_frame(b, frame - region.b_shift, result, frame);
  }
  const SeamMixer mixer(a, b, region);
  const int hips = calibration.bones[Bone::kHips].position_joint;
  for (int frame = region.begin; frame < region.end; ++frame) {
    for (std::size_t joint = 0; joint < result.rotations(frame).size(); ++joint) {
      const auto in = [joint](const Clip& clip, int at) { return clip.rotations(at)[joint]; };
      result.rotations(frame)[joint] = mixer.rotation(in, frame);
    }
    for (std::size_t slot = 0; slot < result.translations(frame).size(); ++slot) {
      const auto in = [slot](const Clip& clip, int at) { return clip.translations(at)[slot]; };
      result.translations(frame)[slot] = mixer.translation(in, frame);
    }
    if (a.skeleton().joint(hips).parent < 0) continue;
    // Clips may distribute the motion differently over the joints above the hips, so blend the
    // world pose of the hips.
    const auto turned = [hips](const Clip& clip, int at) {
      return world_from_joint(clip, at, hips).rotation;
    };
    const auto placed = [hips](const Clip& clip, int at) {
      return world_from_joint(clip, at, hips).translation;
    };
    put_hips(result, frame, hips, {mixer.rotation(turned, frame), mixer.translation(placed, frame)},
             calibration, mover);
  }
  return result;
}

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
