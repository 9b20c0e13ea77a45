// Motions in a single array: Motion-X and PHUMA (NumPy), InterMimic (PyTorch).

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/npz.h"
#include "formats/smpl/motion_arrays.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// Column layout of a kind of array. Rotations are as in AMASS's SMPL-X files.
struct Columns {
  std::size_t width;
  std::size_t root_orient, pose_body, trans;
  std::size_t betas, beta_count;  // beta_count is 0 without betas.
};

constexpr std::size_t kMotionXWidth = 322;
constexpr Columns kMotionX = {kMotionXWidth, 0, 3, 309, 312, 10};
constexpr Columns kPhuma = {69, 3, 6, 0, 0, 0};
constexpr std::size_t kBodyWidth = 63, kHandWidth = 90;
constexpr std::size_t kHumanMlFeatures = 263;

Failure at_file(Error error, const std::string& file_name) {
  error.kind = ErrorKind::kInput;
  error.location.file = file_name;
  return failure(std::move(error));
}

NpyArray columns_of(const std::vector<double>& values, std::size_t width, std::size_t first,
                    std::size_t count) {
  const std::size_t rows = values.size() / width;
  std::vector<double> taken;
  taken.reserve(rows * count);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width + first);
    taken.insert(taken.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  return float64_array(taken, {rows, count});
}

MotionKind kind_of_columns(const Columns& columns) {
  const bool motion_x = columns.width == kMotionXWidth;
  MotionKind kind;
  kind.fps = 30.0;
  kind.fps_reason = fmt::format("the file states no frame rate: assuming 30 fps, as in {}",
                                motion_x ? "Motion-X" : "PHUMA");
  kind.gender = "neutral";
  kind.has_no_betas = columns.beta_count == 0;
  kind.family = SmplFamily::kSmplx;
  kind.y_is_up = !motion_x;
  if (!motion_x) kind.up = Eigen::Vector3d::UnitZ();
  return kind;
}

Failure no_motion(const NpyArray& array, const std::string& file_name) {
  const std::string found =
      "expected an SMPL motion, found an array of shape " + shape_text(array.shape) + ": ";
  if (array.shape.size() == 2 && array.shape[1] == kHumanMlFeatures) {
    return input_failure(file_name, found + "HumanML3D features are not supported",
                         "give the original joint positions (new_joints), or the output of "
                         "recover_from_ric: (frames, 22, 3)");
  }
  const bool may_be_points = array.shape.size() == 2 && array.shape[1] % 3 == 0;
  return input_failure(file_name,
                       found +
                           "Motion-X has 322 columns, PHUMA 69, and joint positions are "
                           "(frames, joints, 3)",
                       may_be_points
                           ? "reshape joint positions to (frames, joints, 3), or name the "
                             "joints with " OPTION("joint-names")
                           : "save all arrays of a motion in one file with numpy.savez");
}

}  // namespace

Result<MotionFile> open_array_motion(std::string_view bytes, const std::string& file_name,
                                     const ArrayReadOptions& options) {
  const Result<NpyHeader> header = take_npy_header(bytes);
  if (!header) return at_file(header.error(), file_name);
  // numpy.save pickles a dictionary, as MDM does with its results.
  if (header->type.ends_with('O')) return open_pickled_motion(bytes, file_name, options);
  const Result<NpyArray> array = read_npy_rest(*header, bytes, options.max_clip_bytes);
  if (!array) return at_file(array.error(), file_name);
  const std::size_t dimensions = array->shape.size();
  const bool may_be_places = dimensions == 3 || dimensions == 4;
  if (array->is_number() && (may_be_places || (dimensions == 2 && !options.joint_names.empty()))) {
    auto places = std::make_unique<MadeArrays>(file_name);
    places->add("positions", *array);
    return MotionFile{std::move(places), {}, {}, MotionContent::kJoints};
  }
  const bool is_table = array->is_number() && dimensions == 2;
  const Columns* columns = nullptr;
  for (const Columns* known : {&kMotionX, &kPhuma}) {
    if (is_table && array->shape[1] == known->width) columns = known;
  }
  if (columns == nullptr) return no_motion(*array, file_name);

  const std::vector<double> values = array->numbers();
  auto arrays = std::make_unique<MadeArrays>(file_name);
  const auto add = [&](const char* name, std::size_t first, std::size_t count) {
    arrays->add(name, columns_of(values, columns->width, first, count));
  };
  add("root_orient", columns->root_orient, 3);
  add("pose_body", columns->pose_body, kBodyWidth);
  // In Motion-X the hands follow the body.
  if (columns == &kMotionX) add("pose_hand", columns->pose_body + kBodyWidth, kHandWidth);
  add("trans", columns->trans, 3);
  if (columns->beta_count > 0) add("betas", columns->betas, columns->beta_count);
  MotionFile file{std::move(arrays), kind_of_columns(*columns), {}};
  if (columns == &kMotionX) {
    file.warnings.push_back({0, 0, "Motion-X clips may use camera axes: check the up axis"});
  }
  return file;
}

namespace {

constexpr std::size_t kFirstPlace = 0, kFirstRotation = 3, kFirstJoint = 9, kFirstBody = 162;
constexpr std::size_t kBodyCount = 52, kFirstUnread = kFirstBody + 3 * kBodyCount;

// Body index of each joint of kSmplJointNames. Bodies are the legs, the trunk with the head, then
// the left and the right arm, each with 15 finger joints after the wrist.
constexpr std::array<int, kSmplJointCount> kBodyOfJoint = {
    0, 1, 5, 9, 2, 6, 10, 3, 7, 11, 4, 8, 12, 14, 33, 13, 15, 34, 16, 35, 17, 36};

// First hand joint after each wrist.
constexpr int kFirstLeftFinger = 18, kFirstRightFinger = 37;

// Converts InterMimic's axes (x forward, y left, z up) to the models' (x left, y up, z forward).
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
      append_vector(poses, log_so3(root));
      for (int joint = 1; joint < kSmplJointCount; ++joint)
        append_vector(poses, rotation(frame, joint));
      for (int joint = 0; joint < kSmplHandJointCount; ++joint) {
        const int in_hand = joint % (kSmplHandJointCount / 2);
        append_vector(
            hands, body_rotation(
                       frame, in_hand + (joint == in_hand ? kFirstLeftFinger : kFirstRightFinger)));
      }
      append_vector(places, vector(frame, kFirstPlace));
      measure_offsets(frame, root);
    }
    TRY(check_offsets());
    const auto body = smpl_rest_body_of_offsets(mean_offset_);
    if (!body) return no_motion("its bones do not form a body in metres");

    auto arrays = std::make_unique<MadeArrays>(file_name_);
    arrays->add("poses", float64_array(poses, {frames_, 3 * kSmplJointCount}));
    arrays->add("pose_hand", float64_array(hands, {frames_, 3 * kSmplHandJointCount}));
    arrays->add("trans", float64_array(places, {frames_, 3}));
    InterMimicMotion motion{std::move(arrays), {}};
    motion.kind.fps = 30.0;
    motion.kind.fps_reason = "the file states no frame rate: assuming InterMimic's 30 fps";
    motion.kind.gender = "neutral";
    motion.kind.up = Eigen::Vector3d::UnitZ();
    motion.kind.has_no_betas = true;
    motion.kind.body = body;
    return motion;
  }

 private:
  [[nodiscard]] Eigen::Vector3d vector(std::size_t frame, std::size_t column) const {
    return Eigen::Map<const Eigen::Vector3d>(values_.data() + frame * kInterMimicColumns + column);
  }

  // Rotation vector of a joint relative to its parent, in the models' axes.
  [[nodiscard]] Eigen::Vector3d rotation(std::size_t frame, int joint) const {
    return body_rotation(frame, kBodyOfJoint[joint]);
  }
  [[nodiscard]] Eigen::Vector3d body_rotation(std::size_t frame, int body) const {
    return smpl_axes(vector(frame, kFirstJoint + 3 * (static_cast<std::size_t>(body) - 1)));
  }

  [[nodiscard]] Eigen::Vector3d place(std::size_t frame, int joint) const {
    return vector(frame, kFirstBody + 3 * static_cast<std::size_t>(kBodyOfJoint[joint]));
  }

  // Pelvis rotation from the models' axes to the world.
  [[nodiscard]] Result<Eigen::Quaterniond> root_rotation(std::size_t frame) const {
    const double* q = values_.data() + frame * kInterMimicColumns + kFirstRotation;
    const Eigen::Quaterniond world_from_body(q[3], q[0], q[1], q[2]);
    if (std::abs(world_from_body.norm() - 1.0) > 0.01) {
      return no_motion(fmt::format("columns 3 to 6 of frame {} are not a unit quaternion", frame));
    }
    const Eigen::Quaterniond body_from_smpl(0.5, 0.5, 0.5, 0.5);
    return world_from_body.normalized() * body_from_smpl;
  }

  // Computes each bone's offset in the axes of its parent, which must be the same in every frame.
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
    return no_motion(fmt::format("bone offsets vary by up to {:.2f} m", spread_));
  }

  [[nodiscard]] Failure no_motion(const std::string& why) const {
    return input_failure(file_name_,
                         fmt::format("the tensor has {} columns like InterMimic's motions, but "
                                     "other contents: {}",
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
