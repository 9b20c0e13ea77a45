#include "edit/ground_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/option_name.h"
#include "retarget/skeleton_points.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Closer to upside down than this, the hips have no heading and keep the previous one.
constexpr double kNoHeading = 1e-3;

bool is_moved(const Clip& clip, int joint) {
  constexpr double kStill = 1e-9;
  const auto slot = static_cast<std::size_t>(clip.skeleton().translation_slot(joint));
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    const auto &turn = clip.rotations(frame)[joint], &first = clip.rotations(0)[joint];
    const Eigen::Vector3d way = clip.translations(frame)[slot] - clip.translations(0)[slot];
    if (way.norm() > kStill || 1.0 - std::abs(turn.dot(first)) > kStill) return true;
  }
  return false;
}

}  // namespace

bool moves_freely(const Joint& joint) {
  int positions = 0, rotations = 0;
  for (const Channel channel : joint.channels) {
    positions += is_position(channel) ? 1 : 0;
    rotations += is_rotation(channel) ? 1 : 0;
  }
  return positions == 3 && rotations >= 3;
}

GroundPose GroundPose::inverse() const {
  const GroundPose turned{Eigen::Vector2d::Zero(), -heading};
  return {-(turned * position), -heading};
}

Pose GroundPose::in_space() const {
  const auto [sine, cosine] = portable::sin_cos(0.5 * heading);
  return {Eigen::Quaterniond(cosine, 0.0, 0.0, sine), {position.x(), position.y(), 0.0}};
}

GroundPose operator*(const GroundPose& a, const GroundPose& b) {
  return {a * b.position, a.heading + b.heading};
}

Eigen::Vector2d operator*(const GroundPose& pose, const Eigen::Vector2d& point) {
  const auto [sine, cosine] = portable::sin_cos(pose.heading);
  return {pose.position.x() + cosine * point.x() - sine * point.y(),
          pose.position.y() + sine * point.x() + cosine * point.y()};
}

GroundPose turn_about(const Eigen::Vector2d& point, double angle) {
  const GroundPose turn{Eigen::Vector2d::Zero(), angle};
  return {point - turn * point, angle};
}

Pose world_from_joint(const Clip& clip, int frame, int joint) {
  Pose pose;
  for (; joint >= 0; joint = clip.skeleton().joint(joint).parent) {
    pose = Pose{clip.rotations(frame)[joint], clip.translation(frame, joint)} * pose;
  }
  return pose;
}

BodyMover::BodyMover(int joint, const Calibration& calibration)
    : joint_(joint),
      metres_per_unit_(calibration.metres_per_unit),
      human_from_source_(calibration.human_from_source) {}

Result<BodyMover> BodyMover::of(const Clip& clip, const Calibration& calibration,
                                const Clip* with) {
  const Skeleton& skeleton = clip.skeleton();
  std::vector<int> chain;
  for (int joint = calibration.bones[Bone::kHips].position_joint; joint >= 0;
       joint = skeleton.joint(joint).parent) {
    chain.push_back(joint);
  }
  const auto is_free = [&](int joint) { return moves_freely(skeleton.joint(joint)); };
  std::erase_if(chain, [&](int joint) { return !is_free(joint); });
  const auto moving = std::ranges::find_if(chain.rbegin(), chain.rend(), [&](int joint) {
    return is_moved(clip, joint) || (with != nullptr && is_moved(*with, joint));
  });
  if (moving != chain.rend()) chain.erase(moving.base(), chain.end());
  bool moves_all = !chain.empty();
  for (const BoneSource& bone : calibration.bones) {
    if (!moves_all || bone.position_joint < 0) continue;
    moves_all = is_above(skeleton, chain.back(), bone.position_joint);
  }
  if (!moves_all) {
    return input_failure(
        {},
        "no joint moves the whole body: neither the root nor a joint between it and the hips has "
        "three position and three rotation channels",
        "use retarget edit transfer to move the motion to a skeleton with such a joint");
  }
  return BodyMover(chain.back(), calibration);
}

void BodyMover::move(Clip& clip, int frame, const Pose& move) const {
  const Skeleton& skeleton = clip.skeleton();
  const Pose world_from_parent = world_from_joint(clip, frame, skeleton.joint(joint_).parent);
  const Pose in_source{human_from_source_.conjugate() * move.rotation * human_from_source_,
                       human_from_source_.conjugate() * move.translation / metres_per_unit_};
  Eigen::Quaterniond& rotation = clip.rotations(frame)[joint_];
  Eigen::Vector3d& translation = clip.translations(frame)[skeleton.translation_slot(joint_)];
  const Pose moved =
      world_from_parent.inverse() * (in_source * (world_from_parent * Pose{rotation, translation}));
  rotation = moved.rotation.normalized();
  translation = moved.translation;
}

void BodyMover::move_all(Clip& clip, const Pose& over_all) const {
  for (int frame = 0; frame < clip.frame_count(); ++frame) move(clip, frame, over_all);
}

std::optional<double> heading_of(const Eigen::Quaterniond& turn) {
  if (turn.z() * turn.z() + turn.w() * turn.w() <= kNoHeading) return std::nullopt;
  return 2.0 * portable::atan2(turn.z(), turn.w());
}

std::vector<GroundPose> hips_over_ground(const HumanClip& human) {
  const Eigen::Quaterniond hips_from_t_pose(
      Eigen::Matrix3d(canonical_t_pose(Bone::kHips).transpose()));
  std::vector<GroundPose> places;
  places.reserve(static_cast<std::size_t>(human.frame_count));
  double before = 0.0;
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const Pose& hips = human.frame(frame)[Bone::kHips];
    const double heading = heading_of(hips.rotation * hips_from_t_pose).value_or(before);
    before += std::remainder(heading - before, 2.0 * std::numbers::pi);
    places.push_back({hips.translation.head<2>(), before});
  }
  return places;
}

// Edits of position: floor height, rotation, translation.

Result<double> floor_height(const Clip& clip, const Calibration& calibration) {
  const Skeleton& skeleton = clip.skeleton();
  // In a clip shorter than the shortest contact, a still foot counts as standing.
  ContactOptions standing;
  standing.shortest = std::min(standing.shortest, clip.frame_count() * clip.rate().frame_time());
  ContactPlan contacts = find_contacts(to_human(clip, calibration), standing);
  std::array<std::vector<SkeletonPoint>, 2> feet;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = side_bone(kSides[foot], LimbBone::kFoot);
    contacts.phases[foot] = on_floor(std::move(contacts.phases[foot]));
    feet[foot] = points_below(skeleton, calibration.bones[bone].position_joint);
  }
  const Eigen::RowVector3d up = calibration.human_from_source.row(2) * calibration.metres_per_unit;
  std::vector<double> heights;
  std::vector<Pose> poses(static_cast<std::size_t>(skeleton.joint_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    for (int foot = 0; foot < 2; ++foot) {
      if (!contacts.in_contact(foot, frame)) continue;
      double lowest = std::numeric_limits<double>::infinity();
      for (const SkeletonPoint& point : feet[foot]) {
        lowest = std::min(lowest, up.dot(world_from_point(point, poses).translation));
      }
      heights.push_back(lowest);
    }
  }
  if (heights.empty()) {
    return input_failure({}, "no foot is ever in contact: cannot infer the floor",
                         RETARGET_OPTION("floor") " H sets the floor height in metres");
  }
  return median(std::move(heights));
}

Result<Clip> put_on_floor(Clip clip, const Calibration& calibration, double floor) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, {Eigen::Quaterniond::Identity(), {0.0, 0.0, -floor}});
  return clip;
}

Result<Clip> turn_clip(Clip clip, const Calibration& calibration, double angle) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  if (clip.frame_count() == 0) return clip;
  const HumanClip first = to_human(cut(clip, 0, 1), calibration);
  mover.move_all(clip, turn_about(hips_over_ground(first).front().position, angle).in_space());
  return clip;
}

Result<Eigen::Vector2d> way_from_text(std::string_view text) {
  std::string_view rest = text;
  const auto x = number_from_text(take_until(rest, ',')), y = number_from_text(rest);
  if (x && y) return Eigen::Vector2d(*x, *y);
  return usage_failure("a move must be X,Y in metres, up to 1000000, found \"" + std::string(text) +
                       "\"");
}

Result<Clip> move_clip(Clip clip, const Calibration& calibration, const Eigen::Vector2d& way) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  mover.move_all(clip, GroundPose{way, 0.0}.in_space());
  return clip;
}

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
  aligned.distance = with_predicted_frame(i, j, aligned);
  return aligned;
}

double WindowDistance::with_predicted_frame(int i, int j, const CloudAlignment& aligned) const {
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
    result.distance = with_predicted_frame(i, j, result);
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
