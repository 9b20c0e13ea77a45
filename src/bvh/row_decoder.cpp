#include "bvh/row_decoder.h"

#include <algorithm>
#include <cmath>

#include "bvh/euler_angles.h"

namespace retarget {
namespace {

// what portable::sin_cos_of_half_degrees takes
constexpr double kMaxAngle = 1e15;

// a loop of its own without any other memory in it, so that compilers make vector code of it
void half_angles(std::span<const double> degrees, double* __restrict sines,
                 double* __restrict cosines) {
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    const auto [sine, cosine] = portable::sin_cos_of_half_degrees(degrees[i]);
    sines[i] = sine;
    cosines[i] = cosine;
  }
}

}  // namespace

RowDecoder::RowDecoder(const Skeleton& skeleton, int first_column) {
  int column = first_column;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    for (const Channel channel : skeleton.joint(joint).channels) {
      if (is_rotation(channel)) {
        rotations_.push_back({column, joint, axis_of(channel)});
      } else if (is_position(channel)) {
        positions_.push_back({column, skeleton.translation_slot(joint), axis_of(channel)});
      }
      ++column;
    }
  }
  angles_.resize(rotations_.size());
  sines_.resize(rotations_.size());
  cosines_.resize(rotations_.size());
}

void RowDecoder::decode(std::span<const double> row, Clip& clip, int frame) {
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    const double angle = row[rotations_[i].column];
    // exact; two whole turns, for half of the angle counts
    angles_[i] = std::abs(angle) < kMaxAngle ? angle : std::remainder(angle, 720.0);
  }
  half_angles(angles_, sines_.data(), cosines_.data());
  const auto rotations = clip.rotations(frame);
  std::ranges::fill(rotations, Eigen::Quaterniond::Identity());
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    rotate_about(rotations[rotations_[i].target], rotations_[i].axis, {sines_[i], cosines_[i]});
  }
  const auto translations = clip.translations(frame);
  for (const Step& step : positions_) translations[step.target][step.axis] = row[step.column];
}

}  // namespace retarget
