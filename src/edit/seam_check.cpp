#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit/seam.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Frame-to-frame change of a bone: speed or acceleration.
struct Change {
  int order;      // 1: speed from two frames, m/s; 2: acceleration from three, m/s^2.
  double gentle;  // Minimum reference value, for clips that stand still.

  // Returns the value of a bone, starting at a frame.
  [[nodiscard]] double at(const HumanClip& human, int frame, Bone bone) const {
    const auto place = [&](int later) -> const Eigen::Vector3d& {
      return human.frame(frame + later)[bone].translation;
    };
    const double fps = human.rate.fps();
    if (order == 1) return (place(1) - place(0)).norm() * fps;
    return (place(2) - 2.0 * place(1) + place(0)).norm() * fps * fps;
  }
};
constexpr Change kSpeed{1, 0.25}, kAcceleration{2, 5.0};

double high_percentile(std::vector<double> values) {
  return values.empty() ? 0.0 : percentile(std::move(values), 99.9);
}

std::vector<double> all_changes(const Change& change, const HumanClip& a, const HumanClip& b,
                                Bone bone) {
  std::vector<double> changes;
  for (const HumanClip* human : {&a, &b}) {
    for (int frame = 0; frame + change.order < human->frame_count; ++frame) {
      changes.push_back(change.at(*human, frame, bone));
    }
  }
  return changes;
}

// The largest change of a bone at a seam, relative to its usual change.
struct LargestChange {
  double usual = 0.0, largest = 0.0;
  std::string bone;
  double share = -1.0;  // Ratio of largest to usual.
};

// Returns the largest change of a bone near this frame in a source clip; 0 if the clip has no such
// frames.
double own_change(const Change& change, const HumanClip& human, int frame, Bone bone) {
  double largest = 0.0;
  for (int near = std::max(frame - 1, 0);
       near <= std::min(frame + 1, human.frame_count - 1 - change.order); ++near) {
    largest = std::max(largest, change.at(human, near, bone));
  }
  return largest;
}

LargestChange find_largest(const Change& change, const HumanClip& a, const HumanClip& b,
                           const HumanClip& joined, const SeamRegion& region) {
  const std::vector<Bone> bones = common_bones(a, b);
  std::vector<std::vector<double>> own;
  std::vector<double> all;
  for (const Bone bone : bones) {
    own.push_back(all_changes(change, a, b, bone));
    all.insert(all.end(), own.back().begin(), own.back().end());
  }
  const double usual_of_all = high_percentile(std::move(all));

  LargestChange found;
  const int end = std::min(region.end + 1, joined.frame_count - change.order);
  for (std::size_t k = 0; k < bones.size(); ++k) {
    const double usual =
        std::max(change.gentle, std::min(usual_of_all, high_percentile(std::move(own[k]))));
    for (int frame = std::max(region.begin - change.order, 0); frame < end; ++frame) {
      const double value = change.at(joined, frame, bones[k]);
      if (value <= found.share * usual) continue;
      // A jolt in the recording is not caused by the seam.
      constexpr double kSame = 1.25;
      if (change.order == 2 &&
          value <= kSame * std::max(own_change(change, a, frame, bones[k]),
                                    own_change(change, b, frame - region.b_shift, bones[k]))) {
        continue;
      }
      found = {usual, value, std::string(bone_name(bones[k])), value / usual};
    }
  }
  return found;
}

// Returns the displacement of an ankle to the next frame; zero outside the clip.
Eigen::Vector3d step_at(const std::vector<Pose>& ankles, int frame) {
  if (frame < 0 || frame + 1 >= static_cast<int>(ankles.size())) return Eigen::Vector3d::Zero();
  const auto at = static_cast<std::size_t>(frame);
  return ankles[at + 1].translation - ankles[at].translation;
}

// Frames per clip to compare.
constexpr int kBeside = 4;

using Samples = Eigen::Matrix<double, 2 * kBeside, Eigen::Dynamic>;

// Returns one row per frame: positions of all bones relative to the last frame of a.
Samples positions_of(const HumanClip& a, const HumanClip& b, const std::vector<Bone>& bones) {
  Samples samples(2 * kBeside, 3 * static_cast<Eigen::Index>(bones.size()));
  const auto frame = [&](int i) -> const HumanPose& {
    return i < 0 ? a.frame(a.frame_count + i) : b.frame(i);
  };
  for (int row = 0; row < 2 * kBeside; ++row) {
    for (std::size_t k = 0; k < bones.size(); ++k) {
      const Bone bone = bones[k];
      samples.block<1, 3>(row, 3 * static_cast<Eigen::Index>(k)) =
          (frame(row - kBeside)[bone].translation - frame(-1)[bone].translation).transpose();
    }
  }
  return samples;
}

// Returns the residual of a polynomial fit to the samples if b begins `spacing` frames after a's
// last frame.
double roughness(const Samples& samples, double spacing) {
  constexpr int kDegree = 4;
  Eigen::Matrix<double, 2 * kBeside, kDegree + 1> powers;
  for (int row = 0; row < 2 * kBeside; ++row) {
    const double time = row < kBeside ? row - kBeside + 1 : spacing + (row - kBeside);
    double power = 1.0;
    for (int degree = 0; degree <= kDegree; ++degree) {
      powers(row, degree) = power;
      power *= time / kBeside;
    }
  }
  const Samples left = samples - powers * powers.colPivHouseholderQr().solve(samples);
  return left.squaredNorm();
}

}  // namespace

SeamCheck check_motion(const HumanClip& a, const HumanClip& b, const HumanClip& joined,
                       const SeamRegion& region, const MotionLimits& limits) {
  const LargestChange speed = find_largest(kSpeed, a, b, joined, region),
                      jolt = find_largest(kAcceleration, a, b, joined, region);
  SeamCheck check;
  check.usual_speed = speed.usual;
  check.largest_speed = speed.largest;
  check.fastest_bone = speed.bone;
  check.usual_acceleration = jolt.usual;
  check.largest_acceleration = jolt.largest;
  check.jolted_bone = jolt.bone;
  const auto too_much = [](const LargestChange& of, const char* does, const char* unit,
                           double factor) {
    return of.bone + does + number_text(of.largest, 2) + unit + ", above " +
           number_text(factor, 1) + " times the clips' own " + number_text(of.usual, 2);
  };
  if (speed.share > limits.speed) {
    check.faults.push_back(too_much(speed, " moves at ", " m/s", limits.speed));
  }
  if (jolt.share > limits.acceleration) {
    check.faults.push_back(too_much(jolt, " accelerates at ", " m/s2", limits.acceleration));
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

std::vector<Warning> as_warnings(const std::vector<std::string>& faults) {
  std::vector<Warning> warnings;
  warnings.reserve(faults.size());
  for (const std::string& fault : faults) warnings.push_back({0, 0, fault});
  return warnings;
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

bool continues_motion(const HumanClip& a, const HumanClip& b) {
  if (a.frame_count < kBeside || b.frame_count < kBeside) return false;
  const Samples samples = positions_of(a, b, common_bones(a, b));
  // The clips must move on, not repeat the same frame.
  constexpr double kStep = 1e-5;
  if (samples.row(kBeside).cwiseAbs().maxCoeff() <= kStep) return false;
  constexpr int kMaxOffset = 24;  // Quarters of a frame.
  double min = std::numeric_limits<double>::infinity();
  int best = 0;
  for (int quarters = -kMaxOffset; quarters <= kMaxOffset; ++quarters) {
    const double left = roughness(samples, 0.25 * quarters);
    if (left >= min) continue;
    min = left;
    best = quarters;
  }
  return best >= 2 && best <= 6;
}

}  // namespace retarget
