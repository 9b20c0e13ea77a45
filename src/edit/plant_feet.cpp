#include "retarget/edit/plant_feet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "edit/fading_offset.h"
#include "edit/two_bone_leg.h"
#include "retarget/edit/ground_pose.h"
#include "retarget/math/so3.h"
#include "retarget/math/trigonometry.h"
#include "retarget/motion/forward_kinematics.h"

namespace retarget {
namespace {

// corrections below this are rounding, metres and radians
constexpr double kNothing = 1e-10;

// what a foot's pose lacks, frame by frame
struct FootOffsets {
  std::vector<Eigen::Vector3d> shifts, turns;  // world, metres and rotation vectors
  std::vector<bool> planted;

  explicit FootOffsets(std::size_t frames)
      : shifts(frames, Eigen::Vector3d::Zero()), turns(shifts), planted(frames, false) {}

  [[nodiscard]] bool any(std::size_t frame) const {
    return shifts[frame].norm() > kNothing || turns[frame].norm() > kNothing;
  }
};

using Track = std::vector<Eigen::Vector3d>;

// fills the frames between two places, or before the first or after the last one
void fade_between(Track& track, const std::vector<bool>& planted, int from, int to, int release) {
  const int frames = static_cast<int>(track.size());
  const auto velocity = [&](int frame, int inwards) -> Eigen::Vector3d {
    const int other = frame + inwards;
    if (other < 0 || other >= frames || !planted[other]) return Eigen::Vector3d::Zero();
    return (track[other] - track[frame]) * inwards;
  };
  // velocities inside the places, before anything is filled
  const Eigen::Vector3d leaving = from >= 0 ? velocity(from, -1) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d coming = to < frames ? velocity(to, 1) : Eigen::Vector3d::Zero();
  if (from >= 0 && to < frames && to - from <= 2 * release) {
    for (int i = from + 1; i < to; ++i) {
      track[i] = ease(track[from], leaving, track[to], coming, to - from, i - from);
    }
    return;
  }
  if (from >= 0) {
    for (int i = from + 1; i < std::min(to, from + release); ++i) {
      track[i] = fade(track[from], leaving, release, i - from);
    }
  }
  if (to < frames) {
    for (int i = to - 1; i > std::max(from, to - release); --i) {
      track[i] = fade(track[to], -coming, release, to - i);
    }
  }
}

FootOffsets offsets_of(std::span<const PlantedFoot> plants, int foot,
                       const std::vector<Pose>& ankles, int release) {
  FootOffsets offsets(ankles.size());
  std::vector<std::pair<int, int>> places;
  for (const PlantedFoot& plant : plants) {
    if (plant.foot != foot || plant.world_from_foot.empty()) continue;
    places.emplace_back(plant.begin, plant.end());
    for (int i = plant.begin; i < plant.end(); ++i) {
      const Pose& wanted = plant.world_from_foot[static_cast<std::size_t>(i - plant.begin)];
      offsets.shifts[i] = wanted.translation - ankles[i].translation;
      offsets.turns[i] = log_so3(wanted.rotation * ankles[i].rotation.conjugate());
      offsets.planted[i] = true;
    }
  }
  const int frames = static_cast<int>(ankles.size());
  for (std::size_t k = 0; k <= places.size() && !places.empty(); ++k) {
    const int from = k == 0 ? -1 : places[k - 1].second - 1;
    const int to = k == places.size() ? frames : places[k].first;
    fade_between(offsets.shifts, offsets.planted, from, to, release);
    fade_between(offsets.turns, offsets.planted, from, to, release);
  }
  return offsets;
}

// at least as much everywhere, without corners: the largest near by, then a mean of those
std::vector<double> smooth_cover(const std::vector<double>& values, int reach) {
  const int count = static_cast<int>(values.size());
  std::vector<double> largest(values.size(), 0.0), result(values.size(), 0.0);
  for (int i = 0; i < count; ++i) {
    if (!(values[i] > 0.0)) continue;
    for (int k = std::max(0, i - reach); k <= std::min(count - 1, i + reach); ++k) {
      largest[k] = std::max(largest[k], values[i]);
    }
  }
  for (int i = 0; i < count; ++i) {
    double sum = 0.0, weights = 0.0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = 1.0 + portable::sin_cos(std::numbers::pi * k / (reach + 1.0)).cosine;
      sum += weight * largest[std::clamp(i + k, 0, count - 1)];
      weights += weight;
    }
    result[i] = sum / weights;
  }
  return result;
}

class FootPlanter {
 public:
  FootPlanter(Clip& clip, const HumanMapping& mapping, const BodyMover& mover,
              const PlantOptions& options)
      : clip_(clip),
        mover_(mover),
        options_(options),
        human_from_source_(mapping.human_from_source),
        metres_per_unit_(mapping.metres_per_unit),
        frames_(static_cast<std::size_t>(clip.frame_count())),
        poses_(static_cast<std::size_t>(clip.skeleton().joint_count())) {
    const auto legs = find_legs(clip.skeleton(), mapping);
    for (int foot = 0; foot < 2; ++foot) {
      if (!legs[foot]) continue;
      const int bone = find_bone(foot == 0 ? "LeftLeg" : "RightLeg").value();
      // knees bend about -z of the canonical shin
      Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();
      const auto& bone_axes = mapping.bones[static_cast<std::size_t>(bone)].joint_from_bone;
      if (bone_axes) axis = *bone_axes * axis;
      solvers_[foot].emplace(*legs[foot], learned_hinge(clip, *legs[foot], axis));
      ankles_[foot] = ankle_poses(clip, mapping, *legs[foot]);
    }
  }

  PlantSummary run(std::span<const PlantedFoot> plants) {
    const int release = in_frames(options_.release);
    std::array<FootOffsets, 2> offsets{FootOffsets(frames_), FootOffsets(frames_)};
    for (int foot = 0; foot < 2; ++foot) {
      if (solvers_[foot]) offsets[foot] = offsets_of(plants, foot, ankles_[foot], release);
    }
    const std::vector<double> drops = find_drops(offsets);
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      const bool lower = drops[frame] > kNothing;
      if (!lower && !offsets[0].any(frame) && !offsets[1].any(frame)) continue;
      const std::array<double, 2> reaches = reaches_at(static_cast<int>(frame));
      if (lower) {
        mover_.move(clip_, static_cast<int>(frame),
                    {Eigen::Quaterniond::Identity(), {0.0, 0.0, -drops[frame]}});
        summary_.largest_drop = std::max(summary_.largest_drop, drops[frame]);
      }
      for (int foot = 0; foot < 2; ++foot) {
        if (!solvers_[foot] || (!lower && !offsets[foot].any(frame))) continue;
        place_foot(offsets[foot], foot, static_cast<int>(frame), reaches[foot]);
      }
    }
    return summary_;
  }

 private:
  [[nodiscard]] int in_frames(double seconds) const {
    return std::max(1, static_cast<int>(std::lround(seconds * clip_.rate().fps())));
  }

  [[nodiscard]] Pose wanted_pose(const FootOffsets& offsets, int foot, int frame) const {
    const Pose& ankle = ankles_[foot][frame];
    return {(exp_so3(offsets.turns[frame]) * ankle.rotation).normalized(),
            ankle.translation + offsets.shifts[frame]};
  }

  // how long each leg may be in a frame, file units
  std::array<double, 2> reaches_at(int frame) {
    forward_kinematics(clip_, frame, poses_);
    std::array<double, 2> reaches{};
    for (int foot = 0; foot < 2; ++foot) {
      if (!solvers_[foot]) continue;
      const LegJoints& leg = solvers_[foot]->joints();
      const double now = (poses_[leg.hip].translation - poses_[leg.ankle].translation).norm();
      reaches[foot] = std::max(now, options_.longest_reach * solvers_[foot]->length(poses_));
    }
    return reaches;
  }

  // how far the hips have to come down for the legs to reach, metres
  std::vector<double> find_drops(const std::array<FootOffsets, 2>& offsets) {
    std::vector<double> drops(frames_, 0.0);
    bool any = false;
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      if (!offsets[0].any(frame) && !offsets[1].any(frame)) continue;
      const auto reaches = reaches_at(static_cast<int>(frame));
      for (int foot = 0; foot < 2; ++foot) {
        if (!solvers_[foot] || !offsets[foot].any(frame)) continue;
        const Eigen::Vector3d hip = human_from_source_ *
                                    poses_[solvers_[foot]->joints().hip].translation *
                                    metres_per_unit_;
        const Eigen::Vector3d from_foot =
            hip - wanted_pose(offsets[foot], foot, static_cast<int>(frame)).translation;
        const double reach = reaches[foot] * metres_per_unit_;
        if (from_foot.norm() <= reach) continue;
        const double left = reach * reach - from_foot.head<2>().squaredNorm();
        const double drop = left > 0.0 ? from_foot.z() - std::sqrt(left) : from_foot.z();
        drops[frame] = std::max(drops[frame], std::clamp(drop, 0.0, options_.deepest_pelvis));
        any = true;
      }
    }
    return any ? smooth_cover(drops, in_frames(options_.pelvis_blend)) : drops;
  }

  void place_foot(const FootOffsets& offsets, int foot, int frame, double reach) {
    const Pose wanted = wanted_pose(offsets, foot, frame);
    const Pose in_source{human_from_source_.conjugate() * wanted.rotation,
                         human_from_source_.conjugate() * wanted.translation / metres_per_unit_};
    const double miss = solvers_[foot]->reach(clip_, frame, in_source, reach) * metres_per_unit_;
    summary_.largest_correction =
        std::max(summary_.largest_correction, offsets.shifts[frame].norm());
    if (offsets.planted[frame]) summary_.largest_miss = std::max(summary_.largest_miss, miss);
  }

  Clip& clip_;
  const BodyMover& mover_;
  const PlantOptions& options_;
  const Eigen::Quaterniond human_from_source_;
  const double metres_per_unit_;
  const std::size_t frames_;
  std::array<std::optional<TwoBoneLeg>, 2> solvers_;
  std::array<std::vector<Pose>, 2> ankles_;
  std::vector<Pose> poses_;  // of a frame
  PlantSummary summary_;
};

bool hangs_below(const Skeleton& skeleton, int joint, int above) {
  while (joint > above) joint = skeleton.joint(joint).parent;
  return joint == above;
}

}  // namespace

std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                  const HumanMapping& mapping) {
  std::array<std::optional<LegJoints>, 2> legs;
  for (int foot = 0; foot < 2; ++foot) {
    const std::string side = foot == 0 ? "Left" : "Right";
    const auto joint_of = [&](const char* part) {
      const auto& bone = mapping.bones[static_cast<std::size_t>(find_bone(side + part).value())];
      // helpers in a joint's place turn with it
      return hangs_below(skeleton, bone.rotation_joint, bone.position_joint) ? bone.position_joint
                                                                             : -1;
    };
    const LegJoints leg{joint_of("UpLeg"), joint_of("Leg"), joint_of("Foot")};
    if (leg.hip >= 0 && leg.knee > leg.hip && leg.ankle > leg.knee &&
        hangs_below(skeleton, leg.knee, leg.hip) && hangs_below(skeleton, leg.ankle, leg.knee)) {
      legs[foot] = leg;
    }
  }
  return legs;
}

std::vector<Pose> ankle_poses(const Clip& clip, const HumanMapping& mapping, const LegJoints& leg) {
  const Eigen::Quaterniond human_from_source(mapping.human_from_source);
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count())), ankles;
  ankles.reserve(static_cast<std::size_t>(clip.frame_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    const Pose& ankle = poses[leg.ankle];
    ankles.push_back({(human_from_source * ankle.rotation).normalized(),
                      human_from_source * ankle.translation * mapping.metres_per_unit});
  }
  return ankles;
}

Result<PlantSummary> plant_feet(Clip& clip, const HumanMapping& mapping,
                                std::span<const PlantedFoot> plants, const PlantOptions& options,
                                const std::string& file) {
  const auto mover = BodyMover::of(clip, mapping, file);
  if (!mover) return failure(mover.error());
  return FootPlanter(clip, mapping, *mover, options).run(plants);
}

std::vector<ContactPhase> without_short_breaks(const std::vector<ContactPhase>& phases,
                                               double seconds, const FrameRate& rate) {
  std::vector<ContactPhase> closed;
  for (const ContactPhase& phase : phases) {
    if (!closed.empty() && (phase.begin - closed.back().end) * rate.frame_time() < seconds) {
      closed.back().end = phase.end;
    } else {
      closed.push_back(phase);
    }
  }
  return closed;
}

}  // namespace retarget
