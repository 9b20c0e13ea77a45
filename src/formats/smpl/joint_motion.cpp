#include "formats/smpl/joint_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/smpl/motion_arrays.h"
#include "formats/smpl/places_layout.h"
#include "motion/odd_rate.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr const char* kRotations = "global_rot_mats";
constexpr std::array kNames = {"joint_names", "names"};

constexpr std::size_t kHumanMlJoints = 22, kClimbJoints = 53, kKimodoRobotJoints = 34;

// Of joint_orders().
constexpr std::string_view kHumanMlOrder = "SMPL";

// Whether the arrays are Kimodo's: joint positions with rotations.
bool is_kimodo(const ArraySource& file) {
  return file.has("posed_joints") && file.has(kRotations);
}

class PlacesReader {
 public:
  PlacesReader(const ArraySource& file, const ArrayReadOptions& options)
      : file_(file), options_(options), name_(places_of(file)) {}

  Result<JointMotion> read() {
    TRY(read_names());
    TRY(find_layout());
    TRY(choose_sample());
    TRY(check_size());
    TRY(read_places());
    if (is_kimodo(file_)) TRY(read_kimodo());
    TRY(read_rate());
    if (auto gaps = missing_frames(file_, motion_.frame_count, motion_.rate)) {
      motion_.warnings.push_back({0, 0, std::move(*gaps)});
    }
    if (const auto odd = odd_rate_text(motion_.rate, motion_.frame_count)) {
      motion_.warnings.push_back({0, 0, "the file gives " + *odd});
    }
    TRY(read_height());
    return std::move(motion_);
  }

 private:
  Result<void> read_names() {
    motion_.names = options_.joint_names;
    if (!motion_.names.empty()) return {};
    for (const char* name : kNames) {
      if (!file_.has(name)) continue;
      TRY_ASSIGN(const auto type, file_.type_of(name));
      if (type.find('O') != std::string::npos) continue;
      TRY_ASSIGN(const auto array, file_.read(name));
      if (!array.is_text() || array.shape.size() != 1) continue;
      motion_.names = array.texts();
      has_own_names_ = true;
      return {};
    }
    return {};
  }

  Result<void> find_layout() {
    TRY_ASSIGN(array_, file_.read(name_));
    const auto layout = layout_of(array_.shape, motion_.names.size());
    if (!array_.is_number() || !layout) {
      return file_.array_failure(
          name_,
          fmt::format("expected joint positions, numbers of shape (frames, joints, 3) or MDM's "
                      "(samples, joints, 3, frames), found {}{}",
                      array_.is_text() ? "text of " : "", shape_text(array_.shape)),
          hint_of_shape());
    }
    layout_ = *layout;
    values_ = array_.numbers();
    const auto settled = is_kimodo(file_) ? layout : settle_people(layout_, values_);
    if (!settled) {
      return file_.array_failure(
          name_,
          fmt::format("its shape {} may be {} motions of {} frames, or {} frames of {} people",
                      shape_text(array_.shape), layout_.samples, layout_.frames, layout_.samples,
                      layout_.frames),
          "save one as (frames, joints, 3): numpy's array[0] is the first motion, array[:, 0] the "
          "first of several people in each frame");
    }
    layout_ = *settled;
    if (array_.element_count() == 0) {
      return file_.array_failure(name_, "it has no frames or no joints");
    }
    if (motion_.names.empty() || motion_.names.size() == layout_.joints) return {};
    const bool are_own = options_.joint_names.empty();
    return file_.array_failure(
        name_,
        fmt::format("it has {}, but there {} in {}", count_text(layout_.joints, "joint"),
                    motion_.names.size() == 1 ? std::string("is 1 name")
                                              : fmt::format("are {} names", motion_.names.size()),
                    are_own ? "the file's joint list" : "the file of " OPTION("joint-names")),
        "give one name per joint, in the order of the array");
  }

  // Explains arrays of detectors of key points.
  [[nodiscard]] std::string hint_of_shape() const {
    const std::vector<std::size_t>& shape = array_.shape;
    if (!array_.is_number() || shape.size() < 3) return "";
    if (shape.back() == 4) {
      return "x, y, z and a confidence? numpy's array[..., :3] removes the confidence";
    }
    if (shape.back() == 2) {
      return "points in an image have no depth; estimate the motion in 3-D first, for example with "
             "GVHMR: docs/smpl.md";
    }
    return "";
  }

  // The number that the user gave, from 1; 0: none.
  [[nodiscard]] std::size_t chosen() const {
    return parse_number<std::size_t>(options_.take).value_or(0);
  }

  Result<void> choose_sample() {
    const std::size_t samples = layout_.samples, number = chosen();
    const char* noun = layout_.are_people ? "person" : "motion";
    const std::string count = layout_.are_people && samples != 1 ? fmt::format("{} people", samples)
                                                                 : count_text(samples, noun);
    if (options_.take.empty()) {
      if (samples == 1) return {};
      return file_.file_failure("the file holds " + count, hint_of_take());
    }
    if (number < 1 || number > samples) {
      return file_.file_failure(
          fmt::format("no {} \"{}\": the file holds {}", noun, options_.take, count),
          hint_of_take());
    }
    sample_ = number - 1;
    if (samples == 1 || !is_absent_sample(layout_, sample_, values_)) return {};
    return file_.file_failure(
        fmt::format("{} {} is absent: NaN or zeros in all frames", noun, number), hint_of_take());
  }

  [[nodiscard]] std::string hint_of_take() const {
    std::vector<std::string> present;
    for (std::size_t sample = 0; sample < layout_.samples; ++sample) {
      if (!is_absent_sample(layout_, sample, values_)) {
        present.push_back(std::to_string(sample + 1));
      }
    }
    const std::size_t absent = layout_.samples - present.size();
    if (absent == 0 || present.empty()) {
      return fmt::format(OPTION("take") " N chooses one, 1 to {}", layout_.samples);
    }
    return fmt::format(OPTION("take") " N chooses one: {}; the other{} absent in all frames",
                       list_names(present, 8), absent == 1 ? " is" : "s are");
  }

  Result<void> check_size() const {
    if (layout_.frames > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
        layout_.joints > 10000) {
      return file_.array_failure(name_, "it has too many frames or joints for a motion");
    }
    constexpr std::size_t kBytes = sizeof(Eigen::Quaterniond) + 2 * sizeof(Eigen::Vector3d);
    if (layout_.frames * layout_.joints <= options_.max_clip_bytes / kBytes) return {};
    return file_.file_failure(
        fmt::format("{} frames need more memory than is allowed", layout_.frames),
        OPTION("memory") " allows more; or split the motion");
  }

  // MDM pads motions to one length and stores their valid lengths.
  Result<std::size_t> frames_that_count() const {
    if (!layout_.frames_last || !file_.has("lengths")) return layout_.frames;
    TRY_ASSIGN(const auto lengths, file_.read("lengths"));
    const bool fits = lengths.is_number() && lengths.element_count() == layout_.samples;
    const double length = fits ? lengths.numbers()[sample_] : 0.0;
    if (!(length >= 1.0)) {
      return file_.array_failure("lengths", "expected one frame count per motion");
    }
    return length < static_cast<double>(layout_.frames) ? static_cast<std::size_t>(length)
                                                        : layout_.frames;
  }

  Result<void> read_places() {
    TRY_ASSIGN(const auto frames, frames_that_count());
    motion_.frame_count = static_cast<int>(frames);
    motion_.joint_count = static_cast<int>(layout_.joints);
    motion_.positions.reserve(frames * layout_.joints);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      for (std::size_t joint = 0; joint < layout_.joints; ++joint) {
        Eigen::Vector3d place;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          place[static_cast<int>(axis)] = values_[layout_.index(sample_, frame, joint, axis)];
        }
        motion_.positions.push_back(place);
      }
    }
    if (const auto lost = bridge_lost_points(motion_)) return missing_joint(*lost);
    return check_places();
  }

  Failure missing_joint(const LostPoint& lost) const {
    const auto joint = static_cast<std::size_t>(lost.joint);
    const std::string name = joint < motion_.names.size() ? " (" + motion_.names[joint] + ")" : "";
    return file_.array_failure(
        name_,
        fmt::format("joint {}{} is missing in frames {} to {}: NaN, or three equal coordinates",
                    joint, name, lost.frames.begin, lost.frames.end - 1),
        fmt::format("missing joints are interpolated for at most {} frames; fill longer gaps, or "
                    "split the motion there",
                    kLongestBridge));
  }

  Result<void> check_places() const {
    for (int frame = 0; frame < motion_.frame_count; ++frame) {
      for (int joint = 0; joint < motion_.joint_count; ++joint) {
        const Eigen::Vector3d& place = motion_.position(frame, joint);
        if (place.allFinite()) continue;
        const bool is_lost = place.array().isNaN().any();
        return file_.array_failure(
            name_,
            fmt::format("{} in frame {}, joint {}", is_lost ? "NaN" : "infinity", frame, joint),
            is_lost ? fmt::format("missing joints (all three coordinates NaN) are interpolated for "
                                  "at most {} frames, not at the start or end",
                                  kLongestBridge)
                    : "");
      }
    }
    return {};
  }

  Result<void> read_kimodo() {
    if (layout_.joints == kKimodoRobotJoints) {
      return file_.file_failure(
          "expected a human motion, found a robot motion: Kimodo's G1",
          "it needs no retargeting; retarget convert reads the CSV that Kimodo writes next to it");
    }
    const JointOrder* order = nullptr;
    for (const JointOrder& one : kimodo_orders()) {
      if (one.joint_count() == layout_.joints) order = &one;
    }
    if (order == nullptr) {
      return file_.file_failure(
          fmt::format("Kimodo's files have 77 or 30 SOMA joints or 22 SMPL-X "
                      "joints, this one has {}",
                      layout_.joints));
    }
    if (motion_.names.empty()) motion_.names = order->names();
    return read_rotations();
  }

  Result<void> read_rotations() {
    TRY_ASSIGN(const auto array, file_.read(kRotations));
    const std::size_t needed = 9 * layout_.samples * layout_.frames * layout_.joints;
    if (!array.is_number() || array.element_count() != needed || array.shape.size() < 4 ||
        array.shape.back() != 3) {
      return file_.array_failure(
          kRotations, fmt::format("expected one matrix for each of the {}, found {}",
                                  count_text(layout_.joints, "joint"), shape_text(array.shape)));
    }
    const std::vector<double> values = array.numbers();
    const std::size_t count = static_cast<std::size_t>(motion_.frame_count) * layout_.joints;
    const std::size_t first = sample_ * layout_.frames * layout_.joints;
    motion_.rotations.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
      const Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(&values[9 * (first + i)]);
      constexpr double kRounding = 0.01;
      const Eigen::Matrix3d square = matrix * matrix.transpose() - Eigen::Matrix3d::Identity();
      // Negated comparison: also rejects NaN.
      if (!(square.norm() < kRounding && matrix.determinant() > 0.0)) {
        return file_.array_failure(kRotations,
                                   fmt::format("invalid rotation matrix in frame {}, joint {}",
                                               i / layout_.joints, i % layout_.joints));
      }
      motion_.rotations.push_back(Eigen::Quaterniond(matrix).normalized());
    }
    return {};
  }

  // Usual rate of a kind of motion.
  struct UsualRate {
    double fps;
    const char* kind;
    std::string_view order = {};  // Empty: any joint order.
  };
  [[nodiscard]] std::optional<UsualRate> usual_rate() const {
    if (is_kimodo(file_)) return UsualRate{30.0, "Kimodo's motions have"};
    if (layout_.joints == kClimbJoints)
      return UsualRate{120.0, "holosoma's motions of 53 joints have"};
    if (is_of_holosoma(name_)) {
      return UsualRate{30.0, "holosoma's scripts write"};
    }
    if (layout_.joints == kHumanMlJoints && !has_own_names_) {
      return UsualRate{20.0, "HumanML3D and MDM have", kHumanMlOrder};
    }
    return std::nullopt;
  }

  Result<void> read_rate() {
    TRY_ASSIGN(const auto stated, read_motion_rate(file_, options_.source_fps));
    if (stated.rate) {
      motion_.rate = *stated.rate;
      for (const Warning& warning : stated.warnings) motion_.warnings.push_back(warning);
      return {};
    }
    const auto usual = usual_rate();
    if (!usual) {
      motion_.no_rate = no_motion_rate(file_).value();
      return {};
    }
    motion_.rate = frame_rate_from_fps(usual->fps);
    motion_.order_of_rate = usual->order;
    if (usual->order == kHumanMlOrder) motion_.up = Eigen::Vector3d::UnitY();
    motion_.warnings.push_back(
        {0, 0,
         fmt::format("the file states no frame rate: assuming {:.0f} fps, as {}", usual->fps,
                     usual->kind)});
    return {};
  }

  Result<void> read_height() {
    if (!file_.has("height")) return {};
    TRY_ASSIGN(const auto array, file_.read("height"));
    if (!array.is_number() || array.element_count() != 1) return {};
    // Accept only plausible heights in metres; the array may hold something else.
    const double height = array.numbers().front();
    if (height >= 0.5 && height <= 2.5) motion_.height = height;
    return {};
  }

  const ArraySource& file_;
  const ArrayReadOptions& options_;
  const std::string name_;
  NpyArray array_;
  std::vector<double> values_;  // Of the array.
  PlacesLayout layout_;
  std::size_t sample_ = 0;
  bool has_own_names_ = false;  // In the file.
  JointMotion motion_;
};

}  // namespace

bool has_joint_positions(const ArraySource& file) {
  return !places_of(file).empty();
}

Result<JointMotion> read_joint_motion(const ArraySource& file, const ArrayReadOptions& options) {
  return PlacesReader(file, options).read();
}

}  // namespace retarget
