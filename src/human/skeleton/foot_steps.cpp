#include "human/skeleton/foot_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "human/skeleton/body_axes.h"
#include "human/skeleton/free_fall.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Approximate duration of a time step, and the approximate limit of their number. Steps are spread
// evenly over the clip.
constexpr double kStepSeconds = 1.0 / 30.0;
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

std::vector<int> feet_of_body(const Body& body) {
  std::vector<int> feet;
  for (const LimbBone part : {LimbBone::kFoot, LimbBone::kToe}) {
    for (const Side side : kSides) {
      const int joint = body.joint(side_bone(side, part));
      if (joint >= 0) feet.push_back(joint);
    }
  }
  return feet;
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

FootSteps::FootSteps(const Clip& clip, const Body& body, const std::vector<int>& slots) {
  const double leg = leg_length(body);
  const std::vector<int> feet = feet_of_body(body);
  const StepFrames steps = frames_of_steps(clip);
  if (!(leg > 0.0) || feet.empty() || steps.begins.empty()) return;
  // Comparing with the frame at doubled root translation isolates the contribution of the root.
  Clip twice(clip.shared_skeleton(), clip.rate(), 1);
  const auto feet_at = [&](int frame) {
    copy_frame(clip, frame, twice, 0);
    for (const int slot : slots) twice.translations(0)[static_cast<std::size_t>(slot)] *= 2.0;
    const JointPoses pose = frame_pose(clip, frame), moved = frame_pose(twice, 0);
    fold_ += fold_of(body, pose) / (2.0 * static_cast<double>(steps.begins.size()));
    std::vector<FootStep> places;
    for (const int foot : feet) {
      const Vector3d by_root = moved[foot].translation - pose[foot].translation;
      places.push_back({by_root, pose[foot].translation - by_root});
    }
    return places;
  };
  const double unit = leg * clip.rate().frame_time() * steps.length;
  for (const int begin : steps.begins) {
    const std::vector<FootStep> before = feet_at(begin);
    std::vector<FootStep> step = feet_at(begin + steps.length);
    for (std::size_t i = 0; i < step.size(); ++i) {
      step[i].by_root = (step[i].by_root - before[i].by_root) / unit;
      step[i].by_others = (step[i].by_others - before[i].by_others) / unit;
    }
    steps_.push_back(std::move(step));
  }
}

double FootSteps::slowest_foot(double root_scale) const {
  double sum = 0.0;
  for (const auto& step : steps_) {
    double slowest = std::numeric_limits<double>::infinity();
    for (const FootStep& foot : step) {
      slowest = std::min(slowest, (root_scale * foot.by_root + foot.by_others).norm());
    }
    sum += slowest;
  }
  return steps_.empty() ? 0.0 : sum / static_cast<double>(steps_.size());
}

double FootSteps::root() const {
  double sum = 0.0;
  for (const auto& step : steps_) sum += step.front().by_root.norm();
  return steps_.empty() ? 0.0 : sum / static_cast<double>(steps_.size());
}

std::vector<int> root_slots(const Skeleton& skeleton, const Body& body) {
  std::vector<int> slots;
  for (int joint = body.joint(Bone::kHips); joint >= 0; joint = skeleton.joint(joint).parent) {
    if (skeleton.translation_slot(joint) >= 0) slots.push_back(skeleton.translation_slot(joint));
  }
  return slots;
}

}  // namespace retarget
