#include "human/skeleton/foot_slides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "human/skeleton/up_evidence.h"
#include "retarget/statistics.h"

namespace retarget {

using Eigen::Vector3d;

std::vector<int> feet_of_body(const Body& body) {
  std::vector<int> feet = body.joints_of(LimbBone::kFoot);
  const std::vector<int> toes = body.joints_of(LimbBone::kToe);
  feet.insert(feet.end(), toes.begin(), toes.end());
  return feet;
}

std::vector<int> supports_of_body(const Body& body) {
  std::vector<int> joints;
  for (const Bone bone : {Bone::kLeftHand, Bone::kRightHand, Bone::kLeftForeArm,
                          Bone::kRightForeArm, Bone::kLeftLeg, Bone::kRightLeg, Bone::kLeftArm,
                          Bone::kRightArm, Bone::kHead, Bone::kSpine2, Bone::kHips}) {
    if (body.joint(bone) >= 0) joints.push_back(body.joint(bone));
  }
  return joints;
}

namespace {

// Positions of all joints, averaged over three frames.
std::vector<Vector3d> smooth_places(const Clip& clip, int frame, int reach) {
  std::vector<Vector3d> places(static_cast<std::size_t>(clip.skeleton().joint_count()),
                               Vector3d::Zero());
  for (const int near : {frame - reach, frame, frame + reach}) {
    const JointPoses pose = frame_pose(clip, near);
    for (std::size_t joint = 0; joint < places.size(); ++joint) {
      places[joint] += pose[joint].translation / 3.0;
    }
  }
  return places;
}

}  // namespace

FootSlides::FootSlides(const Clip& clip, const Body& body, const Vector3d& up) {
  constexpr double kTime = 0.1, kGap = 1.0 / 30.0;  // Seconds.
  constexpr int kMostSamples = 1000;                // Spread evenly over the clip.
  const auto frames_of = [&](double seconds) {
    return static_cast<int>(std::lround(seconds * clip.rate().fps()));
  };
  const int step = std::max(1, frames_of(kTime)), gap = frames_of(kGap);
  const int count = clip.frame_count() - 2 * step - 3 * gap;
  const double leg = leg_length(body);
  const std::vector<int> feet = feet_of_body(body), supports = supports_of_body(body);
  if (!(leg > 0.0) || feet.empty()) return;
  unit_ = leg * step * clip.rate().frame_time();
  for (int begin = 0; begin < count; begin += std::max(step, count / kMostSamples)) {
    const int first = begin + gap, second = first + step + gap;
    // Without the gap, both displacements would have the noise of the frame between them.
    const std::array<std::vector<Vector3d>, 4> places = {
        smooth_places(clip, first, gap), smooth_places(clip, first + step, gap),
        smooth_places(clip, second, gap), smooth_places(clip, second + step, gap)};
    std::vector<Slide>& slides = samples_.emplace_back();
    const auto add = [&](std::size_t joint) {
      slides.push_back({places[1][joint] - places[0][joint], places[3][joint] - places[2][joint]});
    };
    double lowest_foot = std::numeric_limits<double>::infinity();
    for (const int foot : feet) {
      const auto joint = static_cast<std::size_t>(foot);
      lowest_foot = std::min(lowest_foot, up.dot(places[1][joint]));
      add(joint);
    }
    for (const int support : supports) {
      const auto joint = static_cast<std::size_t>(support);
      if (up.dot(places[1][joint]) < lowest_foot) add(joint);
    }
  }
}

double FootSlides::steady(const Eigen::Matrix3d& measured) const {
  if (samples_.empty()) return 0.0;
  std::vector<double> products;
  for (const std::vector<Slide>& slides : samples_) {
    double least = std::numeric_limits<double>::infinity(), product = 0.0;
    for (const Slide& slide : slides) {
      const Vector3d before = measured * slide.before, after = measured * slide.after;
      const double moved = before.squaredNorm() + after.squaredNorm();
      if (moved >= least) continue;
      least = moved;
      product = before.dot(after);
    }
    products.push_back(product);
  }
  return std::sqrt(std::max(0.0, median(std::move(products)))) / unit_;
}

}  // namespace retarget
