#include "edit/pose_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector3d apply(const GroundPose& pose, const Eigen::Vector3d& point) {
  const Eigen::Vector2d flat = pose * Eigen::Vector2d(point.head<2>());
  return {flat.x(), flat.y(), point.z()};
}

}  // namespace

CloudAlignment align_clouds(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b,
                            std::span<const double> weights) {
  double sum = 0.0;
  Eigen::Vector2d centre_a = Eigen::Vector2d::Zero(), centre_b = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += weights[i];
    centre_a += weights[i] * a[i].head<2>();
    centre_b += weights[i] * b[i].head<2>();
  }
  centre_a /= sum;
  centre_b /= sum;
  double across = 0.0, along = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d from = b[i].head<2>() - centre_b, to = a[i].head<2>() - centre_a;
    across += weights[i] * cross(from, to);
    along += weights[i] * from.dot(to);
  }
  CloudAlignment result;
  const GroundPose turn{Eigen::Vector2d::Zero(), portable::atan2(across, along)};
  result.a_from_b = {centre_a - turn * centre_b, turn.heading};
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += weights[i] * (a[i] - apply(result.a_from_b, b[i])).squaredNorm();
  }
  result.distance = std::sqrt(squares / sum);
  return result;
}

PoseClouds::PoseClouds(const HumanClip& human, const std::vector<Bone>& bones)
    : frame_count_(human.frame_count), point_count_(bones.size()) {
  points_.reserve(static_cast<std::size_t>(frame_count_) * point_count_);
  for (int i = 0; i < frame_count_; ++i) {
    for (const Bone bone : bones) points_.push_back(human.frame(i)[bone].translation);
  }
}

std::vector<Bone> common_bones(const HumanClipInfo& a, const HumanClipInfo& b) {
  std::vector<Bone> bones;
  for (const Bone bone : kMappedBones) {
    if (a.has(bone) && b.has(bone)) bones.push_back(bone);
  }
  return bones;
}

WindowDistance::WindowDistance(const PoseClouds& a, const PoseClouds& b, int length)
    : a_(a), b_(b), length_(length), sums_a_(sums_of(a)), sums_b_(sums_of(b)) {}

std::vector<WindowDistance::CloudSums> WindowDistance::sums_of(const PoseClouds& clouds) {
  std::vector<CloudSums> result;
  for (int i = 0; i < clouds.frame_count(); ++i) {
    CloudSums sums;
    for (const Eigen::Vector3d& point : clouds.frame(i)) {
      sums.x += point.x();
      sums.y += point.y();
      sums.squares += point.x() * point.x() + point.y() * point.y();
    }
    result.push_back(sums);
  }
  return result;
}

int WindowDistance::frames_at(int i, int j) const {
  return std::min({length_, a_.frame_count() - i, b_.frame_count() - j});
}

CloudAlignment WindowDistance::at(int i, int j) const {
  const int frames = frames_at(i, j);
  const auto points = a_.frames(i, i + frames);
  const std::vector<double> weights(points.size(), 1.0);
  CloudAlignment aligned = align_clouds(points, b_.frames(j, j + frames), weights);
  aligned.distance = with_foretold(i, j, aligned);
  return aligned;
}

double WindowDistance::with_foretold(int i, int j, const CloudAlignment& aligned) const {
  const int frames = frames_at(i, j);
  if (frames >= length_) return aligned.distance;
  // Predicts the frame after the last common one: the clip's own, or a parabola through its last
  // three.
  const auto next = [frames](const PoseClouds& clouds, int begin, std::size_t point) {
    const int last = begin + frames - 1;
    if (last + 1 < clouds.frame_count()) return clouds.frame(last + 1)[point];
    const Eigen::Vector3d& now = clouds.frame(last)[point];
    if (last == 0) return now;
    const Eigen::Vector3d& before = clouds.frame(last - 1)[point];
    if (last == 1) return Eigen::Vector3d(2.0 * now - before);
    return Eigen::Vector3d(3.0 * (now - before) + clouds.frame(last - 2)[point]);
  };
  double squares = 0.0;
  for (std::size_t point = 0; point < a_.point_count(); ++point) {
    squares += (next(a_, i, point) - apply(aligned.a_from_b, next(b_, j, point))).squaredNorm();
  }
  squares /= static_cast<double>(a_.point_count());
  const double of_window = aligned.distance * aligned.distance;
  return std::sqrt((of_window * frames + squares) / (frames + 1));
}

WindowDistance::PairSums WindowDistance::pair(int i, int j) const {
  // Coordinates are contiguous.
  const double* a = a_.frame(i).data()->data();
  const double* b = b_.frame(j).data()->data();
  const std::size_t count = 3 * a_.point_count();
  PairSums sums;
  for (std::size_t k = 0; k < count; k += 3) {
    sums.dot += a[k] * b[k] + a[k + 1] * b[k + 1];
    sums.cross += b[k] * a[k + 1] - b[k + 1] * a[k];
    sums.rise += (a[k + 2] - b[k + 2]) * (a[k + 2] - b[k + 2]);
  }
  return sums;
}

CloudAlignment WindowDistance::from_sums(const PairSums& sums, int i, int j, int frames) const {
  CloudSums a, b;
  const auto of_a = std::span(sums_a_).subspan(static_cast<std::size_t>(i));
  const auto of_b = std::span(sums_b_).subspan(static_cast<std::size_t>(j));
  for (std::size_t k = 0; k < static_cast<std::size_t>(frames); ++k) {
    for (const auto& [sum, one] : {std::pair(&a, &of_a[k]), std::pair(&b, &of_b[k])}) {
      sum->x += one->x;
      sum->y += one->y;
      sum->squares += one->squares;
    }
  }
  const auto count = static_cast<double>(a_.point_count()) * frames;
  const double along = sums.dot - (a.x * b.x + a.y * b.y) / count;
  const double across = sums.cross - (b.x * a.y - b.y * a.x) / count;
  const double spread =
      a.squares - (a.x * a.x + a.y * a.y) / count + b.squares - (b.x * b.x + b.y * b.y) / count;
  const double rest = spread + sums.rise - 2.0 * std::sqrt(along * along + across * across);
  CloudAlignment result;
  result.distance = std::sqrt(std::max(rest, 0.0) / count);
  if (frames < length_) {
    const GroundPose turn{Eigen::Vector2d::Zero(), portable::atan2(across, along)};
    result.a_from_b = {Eigen::Vector2d(a.x, a.y) / count -
                           turn * Eigen::Vector2d(Eigen::Vector2d(b.x, b.y) / count),
                       turn.heading};
    result.distance = with_foretold(i, j, result);
  }
  return result;
}

std::vector<float> WindowDistance::map(int i_begin, int i_end, int j_begin, int j_end) const {
  const int height = i_end - i_begin, width = j_end - j_begin;
  std::vector<float> result(static_cast<std::size_t>(height) * static_cast<std::size_t>(width));
  std::vector<PairSums> sums;
  // Windows along a diagonal share their pairs of frames.
  for (int diagonal = 1 - height; diagonal < width; ++diagonal) {
    const int first = std::max(0, -diagonal), last = std::min(height, width - diagonal);
    sums.clear();
    for (int row = first; row < last; ++row) {
      const int i = i_begin + row, j = j_begin + row + diagonal;
      const int frames = frames_at(i, j);
      while (static_cast<int>(sums.size()) < row - first + frames) {
        const int step = static_cast<int>(sums.size()) + first;
        sums.push_back(pair(i_begin + step, j_begin + step + diagonal));
      }
      PairSums window;
      const auto begin = static_cast<std::size_t>(row - first);
      for (const PairSums& one : std::span(sums).subspan(begin, static_cast<std::size_t>(frames))) {
        window.dot += one.dot;
        window.cross += one.cross;
        window.rise += one.rise;
      }
      const double distance = from_sums(window, i, j, frames).distance;
      const auto place = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
      result[place + static_cast<std::size_t>(row + diagonal)] = static_cast<float>(distance);
    }
  }
  return result;
}

}  // namespace retarget
