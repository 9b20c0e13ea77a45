#include "smpl/intermimic.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/npz_writer.h"
#include "base/try.h"
#include "math/so3.h"

namespace retarget {
namespace {

constexpr std::size_t kFirstPlace = 0, kFirstRotation = 3, kFirstJoint = 9, kFirstBody = 162;
constexpr std::size_t kBodyCount = 52, kFirstUnread = kFirstBody + 3 * kBodyCount;

// of each of kSmplJointNames its place among the bodies: legs, trunk with the head, then the left
// arm with 15 finger joints before the right one
constexpr std::array<int, kSmplJointCount> kBodyOfJoint = {
    0, 1, 5, 9, 2, 6, 10, 3, 7, 11, 4, 8, 12, 14, 33, 13, 15, 34, 16, 35, 17, 36};

// of the joints of the hands: behind each wrist
constexpr int kFirstLeftFinger = 18, kFirstRightFinger = 37;

// the models' axes (x left, y up, z forward) from InterMimic's (x forward, y left, z up)
Eigen::Vector3d smpl_axes(const Eigen::Vector3d& v) {
  return {v.y(), v.z(), v.x()};
}

class Reader {
 public:
  Reader(std::vector<double> values, std::size_t frames, const std::string& file_name)
      : values_(std::move(values)), frames_(frames), file_name_(file_name) {}

  Result<InterMimicMotion> read() {
    TRY(check_numbers());
    std::vector<double> poses, hands, places;
    poses.reserve(frames_ * 3 * kSmplJointCount);
    places.reserve(3 * frames_);
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      TRY_ASSIGN(const auto root, root_rotation(frame));
      append(poses, log_so3(root));
      for (int joint = 1; joint < kSmplJointCount; ++joint) append(poses, rotation(frame, joint));
      for (int joint = 0; joint < kSmplHandJointCount; ++joint) {
        const int in_hand = joint % (kSmplHandJointCount / 2);
        append(hands, body_rotation(frame, in_hand + (joint == in_hand ? kFirstLeftFinger
                                                                       : kFirstRightFinger)));
      }
      append(places, vector(frame, kFirstPlace));
      measure_offsets(frame, root);
    }
    TRY(check_offsets());
    const auto body = smpl_rest_body_of_offsets(mean_offset_);
    if (!body) return no_motion("its bones make no body in metres");

    auto arrays = std::make_unique<MadeArrays>(file_name_);
    arrays->add("poses", float64_array(poses, {frames_, 3 * kSmplJointCount}));
    arrays->add("pose_hand", float64_array(hands, {frames_, 3 * kSmplHandJointCount}));
    arrays->add("trans", float64_array(places, {frames_, 3}));
    InterMimicMotion motion{std::move(arrays), {}};
    motion.kind.fps = 30.0;
    motion.kind.fps_reason =
        "the file states no frame rate: 30 fps, as InterMimic's motions have, are assumed";
    motion.kind.gender = "neutral";
    motion.kind.has_no_betas = true;
    motion.kind.body = body;
    return motion;
  }

 private:
  static void append(std::vector<double>& values, const Eigen::Vector3d& v) {
    values.insert(values.end(), {v.x(), v.y(), v.z()});
  }

  [[nodiscard]] Eigen::Vector3d vector(std::size_t frame, std::size_t column) const {
    return Eigen::Map<const Eigen::Vector3d>(values_.data() + frame * kInterMimicColumns + column);
  }

  // of a joint against its parent, a rotation vector in the models' axes
  [[nodiscard]] Eigen::Vector3d rotation(std::size_t frame, int joint) const {
    return body_rotation(frame, kBodyOfJoint[joint]);
  }
  [[nodiscard]] Eigen::Vector3d body_rotation(std::size_t frame, int body) const {
    return smpl_axes(vector(frame, kFirstJoint + 3 * (static_cast<std::size_t>(body) - 1)));
  }

  [[nodiscard]] Eigen::Vector3d place(std::size_t frame, int joint) const {
    return vector(frame, kFirstBody + 3 * static_cast<std::size_t>(kBodyOfJoint[joint]));
  }

  // of the pelvis in the world, from the models' axes
  [[nodiscard]] Result<Eigen::Quaterniond> root_rotation(std::size_t frame) const {
    const double* q = values_.data() + frame * kInterMimicColumns + kFirstRotation;
    const Eigen::Quaterniond world_from_body(q[3], q[0], q[1], q[2]);
    if (std::abs(world_from_body.norm() - 1.0) > 0.01) {
      return no_motion(fmt::format("columns 3 to 6 of frame {} are no unit quaternion", frame));
    }
    const Eigen::Quaterniond body_from_smpl(0.5, 0.5, 0.5, 0.5);
    return world_from_body.normalized() * body_from_smpl;
  }

  // in the axes of its parent each bone keeps its place
  void measure_offsets(std::size_t frame, const Eigen::Quaterniond& root) {
    std::array<Eigen::Quaterniond, kSmplJointCount> world;
    world[0] = root;
    for (int joint = 1; joint < kSmplJointCount; ++joint) {
      const int parent = kSmplParents[joint];
      world[joint] = world[parent] * exp_so3(rotation(frame, joint));
      const Eigen::Vector3d offset =
          world[parent].conjugate() * (place(frame, joint) - place(frame, parent));
      if (frame == 0) first_offset_[joint] = offset;
      spread_ = std::max(spread_, (offset - first_offset_[joint]).norm());
      mean_offset_[joint] += offset / static_cast<double>(frames_);
    }
    spread_ = std::max(spread_, (place(frame, 0) - vector(frame, kFirstPlace)).norm());
  }

  [[nodiscard]] Result<void> check_numbers() const {
    if (frames_ == 0) return input_failure(file_name_, "the motion has no frames");
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      for (std::size_t column = 0; column < kFirstUnread; ++column) {
        const double value = values_[frame * kInterMimicColumns + column];
        if (std::isfinite(value)) continue;
        return input_failure(file_name_,
                             fmt::format("{} in frame {}, column {}",
                                         std::isnan(value) ? "NaN" : "infinity", frame, column));
      }
    }
    return {};
  }

  [[nodiscard]] Result<void> check_offsets() const {
    constexpr double kMaxSpread = 0.01;
    if (spread_ <= kMaxSpread) return {};
    return no_motion(fmt::format("bones change their place by up to {:.2f} m", spread_));
  }

  [[nodiscard]] Failure no_motion(const std::string& why) const {
    return input_failure(file_name_,
                         fmt::format("the tensor has {} columns as InterMimic's motions have, but "
                                     "something else in them: {}",
                                     kInterMimicColumns, why));
  }

  std::vector<double> values_;
  std::size_t frames_;
  const std::string& file_name_;
  std::array<Eigen::Vector3d, kSmplJointCount> first_offset_ = zeros();
  std::array<Eigen::Vector3d, kSmplJointCount> mean_offset_ = zeros();
  double spread_ = 0.0;

  static std::array<Eigen::Vector3d, kSmplJointCount> zeros() {
    std::array<Eigen::Vector3d, kSmplJointCount> all;
    all.fill(Eigen::Vector3d::Zero());
    return all;
  }
};

}  // namespace

Result<InterMimicMotion> read_intermimic(const NpyArray& table, const std::string& file_name) {
  return Reader(table.numbers(), table.shape[0], file_name).read();
}

}  // namespace retarget
