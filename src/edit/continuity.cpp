#include "edit/seam.h"

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "edit/pose_distance.h"
#include "retarget/human.h"

namespace retarget {
namespace {

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
