#include "edit/plant_feet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "edit/foot_offsets.h"
#include "edit/ground_pose.h"
#include "edit/seam_blend.h"
#include "retarget/clip.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Metres: smaller drops are rounding errors.
constexpr double kNoDrop = 1e-10;

// Returns a smooth upper bound: a sliding maximum followed by a sliding mean.
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
  FootPlanter(Clip& clip, const Calibration& calibration, const BodyMover& mover,
              const PlantOptions& options)
      : clip_(clip),
        mover_(mover),
        options_(options),
        human_from_source_(calibration.human_from_source),
        metres_per_unit_(calibration.metres_per_unit),
        frames_(static_cast<std::size_t>(clip.frame_count())) {
    const auto legs = find_legs(clip.skeleton(), calibration);
    for (int foot = 0; foot < 2; ++foot) {
      if (!legs[foot]) continue;
      const Bone bone = side_bone(kSides[foot], LimbBone::kLeg);
      // Knees bend about -z of the canonical shin.
      Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();
      const auto& bone_axes = calibration.bones[bone].joint_from_bone;
      if (bone_axes) axis = *bone_axes * axis;
      solvers_[foot].emplace(*legs[foot], learned_hinge(clip, *legs[foot], axis));
      tracks_[foot] = track_leg(clip, calibration, *legs[foot]);
    }
  }

  PlantSummary run(std::span<const PlantedFoot> plants) {
    const int release = frames_in(options_.release, clip_.rate());
    std::array<FootOffsets, 2> offsets{FootOffsets(frames_), FootOffsets(frames_)};
    for (int foot = 0; foot < 2; ++foot) {
      if (solvers_[foot]) offsets[foot] = planted_offsets(plants, foot, tracks_[foot]);
    }
    // A foot flat on the floor needs the hips lowered; a foot on its toes can rise on them instead.
    std::vector<double> drops = find_drops(offsets, false);
    for (int foot = 0; foot < 2; ++foot) {
      if (!solvers_[foot]) continue;
      rise_on_toes(offsets[foot], plants, foot, tracks_[foot], drops, options_, release);
      fade_offsets(offsets[foot], release);
    }
    drops = find_drops(offsets, true);
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      const bool lower = drops[frame] > kNoDrop;
      if (!lower && !offsets[0].any(frame) && !offsets[1].any(frame)) continue;
      if (lower) {
        mover_.move(clip_, static_cast<int>(frame),
                    {Eigen::Quaterniond::Identity(), {0.0, 0.0, -drops[frame]}});
        summary_.largest_drop = std::max(summary_.largest_drop, drops[frame]);
      }
      for (int foot = 0; foot < 2; ++foot) {
        if (!solvers_[foot] || (!lower && !offsets[foot].any(frame))) continue;
        place_foot(offsets[foot], foot, frame, drops[frame]);
      }
    }
    return summary_;
  }

 private:
  // Returns how far the hips must be lowered for the legs to reach, metres.
  [[nodiscard]] std::vector<double> find_drops(const std::array<FootOffsets, 2>& offsets,
                                               bool on_toes) const {
    std::vector<double> drops(frames_, 0.0);
    bool any = false;
    for (int foot = 0; foot < 2; ++foot) {
      if (!solvers_[foot]) continue;
      for (std::size_t frame = 0; frame < frames_; ++frame) {
        if (!offsets[foot].planted[frame] || !offsets[foot].any(frame)) continue;
        if (offsets[foot].heel_up[frame] && !on_toes) continue;
        const Eigen::Vector3d from_foot =
            tracks_[foot].hips[frame] - offsets[foot].moved(frame, tracks_[foot]).translation;
        const double reach = offsets[foot].reach(frame, tracks_[foot], 0.0, options_).easily();
        if (from_foot.norm() <= reach) continue;
        const double left = reach * reach - from_foot.head<2>().squaredNorm();
        const double drop = left > 0.0 ? from_foot.z() - std::sqrt(left) : from_foot.z();
        // Limits the drop for low hips, so that a sitting or lying body stays above the floor.
        constexpr double kLower = 0.125;
        const double deepest = std::clamp(kLower * from_foot.z(), 0.0, options_.deepest_pelvis);
        drops[frame] = std::max(drops[frame], std::clamp(drop, 0.0, deepest));
        any = true;
      }
    }
    return any ? smooth_cover(drops, frames_in(options_.pelvis_blend, clip_.rate())) : drops;
  }

  void place_foot(const FootOffsets& offsets, int foot, std::size_t frame, double drop) {
    const Pose wanted = offsets.moved(frame, tracks_[foot]);
    const Pose in_source{human_from_source_.conjugate() * wanted.rotation,
                         human_from_source_.conjugate() * wanted.translation / metres_per_unit_};
    LegReach stretch = offsets.reach(frame, tracks_[foot], drop, options_);
    stretch.begin /= metres_per_unit_;
    stretch.room /= metres_per_unit_;
    const double miss = solvers_[foot]->reach(clip_, static_cast<int>(frame), in_source, stretch) *
                        metres_per_unit_;
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
  std::array<LegTrack, 2> tracks_;
  PlantSummary summary_;
};

}  // namespace

LegTrack track_leg(const Clip& clip, const Calibration& calibration, const LegJoints& leg) {
  const Eigen::Quaterniond human_from_source(calibration.human_from_source);
  const double metres_per_unit = calibration.metres_per_unit;
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  LegTrack track;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    const Pose& ankle = poses[leg.ankle];
    track.hips.emplace_back(human_from_source * poses[leg.hip].translation * metres_per_unit);
    track.ankles.push_back({(human_from_source * ankle.rotation).normalized(),
                            human_from_source * ankle.translation * metres_per_unit});
    const Eigen::Vector3d& knee = poses[leg.knee].translation;
    track.lengths.push_back(
        ((knee - poses[leg.hip].translation).norm() + (ankle.translation - knee).norm()) *
        metres_per_unit);
  }
  return track;
}

std::vector<Pose> ankle_poses(const Clip& clip, const Calibration& calibration,
                              const LegJoints& leg) {
  return track_leg(clip, calibration, leg).ankles;
}

Result<PlantSummary> plant_feet(Clip& clip, const Calibration& calibration,
                                std::span<const PlantedFoot> plants, const PlantOptions& options) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  return FootPlanter(clip, calibration, mover, options).run(plants);
}

std::string planted_text(const PlantSummary& feet) {
  return "moved by up to " + number_text(100.0 * feet.largest_correction, 1) +
         " cm to stand, hips lowered by up to " + number_text(100.0 * feet.largest_drop, 1) + " cm";
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
