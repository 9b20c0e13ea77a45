#include "live/stream/file_axes.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "retarget/so3.h"

namespace retarget {
namespace {

double total_length(std::span<const Eigen::Vector3d> offsets) {
  double length = 0.0;
  for (const Eigen::Vector3d& offset : offsets) length += offset.norm();
  return length;
}

// Infers the file's units per unit of the stream. Both may have the same unit, whatever it is.
double unit_scale(double stream_length, std::optional<double> metres_per_unit, double file_length) {
  if (!metres_per_unit || !(stream_length > 0.0) || !(file_length > 0.0)) return 1.0;
  std::vector<double> scales = {1.0};
  for (const double units : kUnitsPerMetre) scales.push_back(units * *metres_per_unit);
  return *std::ranges::min_element(scales, {}, [&](double scale) {
    const double ratio = scale * stream_length / file_length;
    return std::max(ratio, 1.0 / ratio);
  });
}

// The 24 rotations that map axes to axes.
std::vector<Eigen::Quaterniond> axis_rotations() {
  std::vector<Eigen::Quaterniond> all;
  for (const int x : {0, 1, 2}) {
    for (const int y : {(x + 1) % 3, (x + 2) % 3}) {
      for (const double first : {1.0, -1.0}) {
        for (const double second : {1.0, -1.0}) {
          Eigen::Matrix3d axes;
          axes.col(0) = first * Eigen::Vector3d::Unit(x);
          axes.col(1) = second * Eigen::Vector3d::Unit(y);
          axes.col(2) = axes.col(0).cross(axes.col(1));
          all.emplace_back(axes);
        }
      }
    }
  }
  return all;
}

// The rotation of the stream's joint axes to the file's, from the directions of the bones. Trackers
// and software that write the zero pose upright in their own world differ by one.
Eigen::Quaterniond joint_rotation(std::span<const Eigen::Vector3d> stream, double scale,
                                  std::span<const Eigen::Vector3d> file) {
  constexpr double kAgree = 0.25, kMatch = 0.1;  // Mean error as a fraction of the length.
  const double length = total_length(file);
  const auto error = [&](const Eigen::Quaterniond& rotation) {
    double sum = 0.0;
    for (std::size_t i = 0; i < file.size(); ++i) {
      sum += (file[i] - scale * (rotation * stream[i])).norm();
    }
    return sum;
  };
  const Eigen::Quaterniond same = Eigen::Quaterniond::Identity();
  if (error(same) <= kAgree * length) return same;
  const auto all = axis_rotations();
  const Eigen::Quaterniond best = *std::ranges::min_element(all, {}, error);
  return error(best) <= kMatch * length ? best : same;
}

}  // namespace

FileAxes::FileAxes(const SkeletonAxes& stream, std::optional<double> metres_per_unit,
                   const SkeletonAxes& file)
    : scale_(
          unit_scale(total_length(stream.offsets), metres_per_unit, total_length(file.offsets))) {
  joints_ = joint_rotation(stream.offsets, scale_, file.offsets);
  world_ = joints_;
  constexpr double kSame = 1e-6;
  // The heading of the world is free.
  if (!stream.up || !file.up || (joints_ * *stream.up - *file.up).norm() < kSame) return;
  world_ = rotation_between(*stream.up, *file.up);
}

}  // namespace retarget
