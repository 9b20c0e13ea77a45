#include "human/skeleton/foot_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "human/skeleton/foot_slides.h"

namespace retarget {

using Eigen::Vector3d;

namespace {

// Approximate duration of a time step.
constexpr double kStepSeconds = 1.0 / 30.0;

// Approximate limit of the number of steps, which are spread evenly over the clip.
constexpr int kMaxSteps = 1000;

// First frames of the steps, and the length of a step in frames.
struct StepFrames {
  std::vector<int> begins;
  int length = 1;
};

StepFrames frames_of_steps(const Clip& clip) {
  StepFrames steps;
  steps.length = std::max(1, static_cast<int>(std::lround(kStepSeconds * clip.rate().fps())));
  const int count = clip.frame_count() - steps.length;
  const int stride = std::max(steps.length, count / kMaxSteps);
  for (int frame = 0; frame < count; frame += stride) steps.begins.push_back(frame);
  return steps;
}

// Mean cosine between trunk and legs.
double fold_of(const Body& body, const JointPoses& pose) {
  const auto trunk = trunk_direction(body, pose);
  if (!trunk) return 0.0;
  double sum = 0.0;
  for (const Side side : kSides) {
    const int thigh = body.joint(side_bone(side, LimbBone::kUpLeg));
    const int foot = body.joint(side_bone(side, LimbBone::kFoot));
    if (thigh < 0 || foot < 0) continue;
    sum += 0.5 * trunk->dot((pose[foot].translation - pose[thigh].translation).normalized());
  }
  return sum;
}

}  // namespace

FootSteps::FootSteps(const Clip& clip, const Body& body, const std::vector<int>& slots,
                     const std::optional<Vector3d>& up) {
  const double leg = leg_length(body);
  const std::vector<int> feet = feet_of_body(body);
  std::vector<int> joints = feet;
  if (up) {
    const std::vector<int> supports = supports_of_body(body);
    joints.insert(joints.end(), supports.begin(), supports.end());
  }
  const StepFrames steps = frames_of_steps(clip);
  if (!(leg > 0.0) || feet.empty() || steps.begins.empty()) return;
  // Comparing with the frame at doubled root translation isolates the contribution of the root.
  Clip twice(clip.shared_skeleton(), clip.rate(), 1);
  const auto places_at = [&](int frame) {
    copy_frame(clip, frame, twice, 0);
    for (const int slot : slots) twice.translations(0)[static_cast<std::size_t>(slot)] *= 2.0;
    const JointPoses pose = frame_pose(clip, frame), moved = frame_pose(twice, 0);
    fold_ += fold_of(body, pose) / (2.0 * static_cast<double>(steps.begins.size()));
    std::vector<FootStep> places;
    for (const int joint : joints) {
      const Vector3d by_root = moved[joint].translation - pose[joint].translation;
      places.push_back({by_root, pose[joint].translation - by_root});
    }
    return places;
  };
  const auto height = [&](const FootStep& place) {
    return up->dot(place.by_root + place.by_others);
  };
  const double unit = leg * clip.rate().frame_time() * steps.length;
  for (const int begin : steps.begins) {
    const std::vector<FootStep> before = places_at(begin), after = places_at(begin + steps.length);
    std::vector<FootStep> step;
    double lowest_foot = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const bool is_foot = i < feet.size();
      if (up && is_foot) lowest_foot = std::min(lowest_foot, height(before[i]));
      if (!is_foot && height(before[i]) >= lowest_foot) continue;
      step.push_back({(after[i].by_root - before[i].by_root) / unit,
                      (after[i].by_others - before[i].by_others) / unit});
    }
    steps_.push_back(std::move(step));
  }
}

double FootSteps::root(const Eigen::Matrix3d& measured) const {
  double sum = 0.0;
  for (const auto& step : steps_) sum += (measured * step.front().by_root).norm();
  return steps_.empty() ? 0.0 : sum / static_cast<double>(steps_.size());
}

}  // namespace retarget
