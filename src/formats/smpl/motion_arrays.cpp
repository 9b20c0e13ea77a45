#include "formats/smpl/motion_arrays.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "motion/odd_rate.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kRootAxes = 3;
constexpr std::size_t kBodyColumns = 3 * (kSmplJointCount - 1);
constexpr std::size_t kUsedColumns = kRootAxes + kBodyColumns;

constexpr std::size_t kSmplColumns = 72;
constexpr std::size_t kSmplhColumns = 156;
constexpr std::size_t kSmplxColumns = 165;
constexpr std::size_t kHandColumns = 3 * kSmplHandJointCount;  // The last columns of both layouts.
constexpr const char* kLeftHand = "left_hand_pose";
constexpr const char* kRightHand = "right_hand_pose";

// Names of rotations in one array, or in two (pelvis, body), used by AMASS, smplx, AIST++ and fits
// to video. Precedence: AMASS's separate arrays, AMASS's single array, then the others. The entry
// of kTranslations with the same index has the same origin.
constexpr std::array<const char*, 4> kWholePoses = {"poses", "fullpose", "smpl_poses",
                                                    "pose_world"};
constexpr std::array<std::pair<const char*, const char*>, 2> kPartedPoses = {
    {{"root_orient", "pose_body"}, {"global_orient", "body_pose"}}};
constexpr std::array<const char*, 4> kTranslations = {"trans", "transl", "smpl_trans",
                                                      "trans_world"};

// Numbers with one row per frame.
struct Table {
  std::vector<double> values;
  std::size_t rows = 0;
  std::size_t width = 0;
  std::size_t used = 0;  // Number of leading columns that are checked.

  [[nodiscard]] Eigen::Vector3d vector(std::size_t row, std::size_t column) const {
    return Eigen::Map<const Eigen::Vector3d>(values.data() + row * width + column);
  }
};

// Number of columns; accepts (F, W) and (F, W / 3, 3), as some programs write rotation vectors.
std::size_t width_of(const std::vector<std::size_t>& shape) {
  if (shape.size() == 2) return shape[1];
  return shape.size() == 3 && shape[2] == 3 && shape[1] < kSmplxColumns ? 3 * shape[1] : 0;
}

const char* first_of(const ArraySource& file, std::span<const char* const> names) {
  const auto found = std::ranges::find_if(names, [&](const char* name) { return file.has(name); });
  return found == names.end() ? nullptr : *found;
}

// The translations of the same origin as the rotations, otherwise the first ones: WHAM's files have
// `trans` in camera axes next to `trans_world`.
const char* translations_of(const ArraySource& file, const char* whole_poses) {
  const auto at = std::ranges::find(kWholePoses, whole_poses) - kWholePoses.begin();
  const auto index = static_cast<std::size_t>(at);
  if (index < kTranslations.size() && file.has(kTranslations[index])) return kTranslations[index];
  const char* found = first_of(file, kTranslations);
  return found != nullptr ? found : kTranslations.front();
}

const std::pair<const char*, const char*>* parted_poses(const ArraySource& file) {
  const auto found = std::ranges::find_if(kPartedPoses, [&](const auto& names) {
    const bool is_custom = &names == &kPartedPoses.front() || !file.has(kWholePoses.front());
    return is_custom && file.has(names.first) && file.has(names.second);
  });
  return found == kPartedPoses.end() ? nullptr : &*found;
}

std::string fault_of(double value) {
  if (std::isfinite(value)) {
    return fmt::format("expected rotation vectors in radians, found {:f}", value);
  }
  return std::isnan(value) ? "NaN" : "infinity";
}

class MotionReader {
 public:
  MotionReader(const ArraySource& file, const MotionKind& kind) : file_(file), kind_(kind) {}

  Result<MotionArrays> read(std::optional<double> source_fps) {
    TRY(read_rotations());
    read_hands();
    TRY(read_translations());
    TRY(read_rate(source_fps));
    if (auto gaps = missing_frames(file_, arrays_.frame_count, arrays_.rate)) {
      warn(std::move(*gaps));
    }
    if (const auto odd = odd_rate_text(arrays_.rate, arrays_.frame_count)) {
      warn("the file gives " + *odd);
    }
    TRY(read_betas());
    TRY(read_gender());
    TRY(read_family());
    TRY(read_rest_offsets());
    return std::move(arrays_);
  }

 private:
  // Reads a table whose width is one of `widths`. Only the first of these widths is used.
  Result<Table> read_table(const char* name, std::initializer_list<std::size_t> widths,
                           double max = std::numeric_limits<double>::infinity()) const {
    TRY_ASSIGN(const auto array, file_.read(name));
    const std::size_t width = width_of(array.shape);
    if (!array.is_number() || std::ranges::find(widths, width) == widths.end()) {
      return file_.array_failure(
          name, fmt::format("expected numbers of shape (frames, {}), found {}{}",
                            fmt::join(widths, ") or (frames, "), array.is_text() ? "text of " : "",
                            shape_text(array.shape)));
    }
    const std::size_t rows = array.shape[0], used = *widths.begin();
    if (rows == 0) return file_.array_failure(name, "it has no frames");
    if (rows > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      return file_.array_failure(name, "it has too many frames");
    }
    Table table{array.numbers(), rows, width, used};
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < used; ++column) {
        const double value = table.values[row * width + column];
        if (std::abs(value) <= max && std::isfinite(value)) continue;
        return file_.array_failure(
            name, fmt::format("{} in frame {}, column {}", fault_of(value), row, column));
      }
    }
    return table;
  }

  // @param other  the array with a different number of frames
  Failure other_length(const char* name, const Table& table, const char* other, std::size_t rows) {
    return file_.array_failure(name,
                               fmt::format("it has {} frames, {} {}", table.rows, other, rows));
  }

  Result<void> read_rotations() {
    // No joint turns this far: larger values are degrees or not rotations at all.
    constexpr double kMaxRadians = 100.0;
    std::vector<Table> tables;
    const char* name = nullptr;
    if (const auto* parts = parted_poses(file_)) {
      TRY_ASSIGN(Table root, read_table(parts->first, {kRootAxes}, kMaxRadians));
      // 69 columns include SMPL's two hand joints.
      TRY_ASSIGN(Table body,
                 read_table(parts->second, {kBodyColumns, kSmplColumns - kRootAxes}, kMaxRadians));
      if (root.rows != body.rows) {
        return other_length(parts->second, body, (std::string(parts->first) + " has").c_str(),
                            root.rows);
      }
      name = parts->second;
      tables = {std::move(root), std::move(body)};
    } else if (const char* whole = first_of(file_, kWholePoses)) {
      TRY_ASSIGN(Table poses,
                 read_table(whole, {kUsedColumns, kSmplColumns, kSmplhColumns, kSmplxColumns},
                            kMaxRadians));
      name = whole;
      whole_poses_ = whole;
      pose_width_ = poses.width;
      tables = {std::move(poses)};
    } else {
      return no_motion();
    }
    const std::size_t rows = tables.front().rows;
    arrays_.frame_count = static_cast<int>(rows);
    arrays_.rotations.reserve(rows * kSmplJointCount);
    for (std::size_t row = 0; row < rows; ++row) {
      for (const Table& table : tables) {
        for (std::size_t column = 0; column < table.used; column += 3) {
          arrays_.rotations.push_back(table.vector(row, column));
        }
      }
    }
    if (const auto found = find_degrees(arrays_.rotations)) {
      return file_.array_failure(
          name,
          fmt::format("{} in frame {}, {}", fault_of(found->value), found->frame, found->joint),
          fmt::format("{} joints turn by more than two turns: are these degrees?", found->joints));
    }
    return {};
  }

  // Columns of an array that hold the fingers of one hand or both.
  struct HandPart {
    const char* name;
    std::size_t first, count;
    std::size_t first_joint = 0;
  };
  [[nodiscard]] std::vector<HandPart> hand_parts() const {
    constexpr std::size_t kOneHand = kHandColumns / 2;
    const HandPart left = {kLeftHand, 0, kOneHand};
    const HandPart right = {kRightHand, 0, kOneHand, kOneHand / 3};
    const bool has_left = file_.has(kLeftHand), has_right = file_.has(kRightHand);
    if (file_.has("pose_hand")) return {{"pose_hand", 0, kHandColumns}};
    if (has_left && has_right) return {left, right};
    if (parted_poses(file_) == nullptr && whole_poses_ != nullptr && pose_width_ >= kSmplhColumns) {
      return {{whole_poses_, pose_width_ - kHandColumns, kHandColumns}};
    }
    if (has_left) return {left};
    if (has_right) return {right};
    return {};
  }

  // Reads finger rotations from the whole poses or from separate arrays. Fingers are optional:
  // malformed ones are ignored without rejecting the motion or the other hand.
  void read_hands() {
    const std::vector<HandPart> parts = hand_parts();
    const auto frames = static_cast<std::size_t>(arrays_.frame_count);
    std::vector<Eigen::Vector3d> rotations(frames * kSmplHandJointCount, Eigen::Vector3d::Zero());
    std::vector<std::string> faults;
    bool are_faults_zero = true;
    for (const HandPart& part : parts) {
      const auto array = file_.read(part.name);
      auto fault = array ? add_hand(part, *array, rotations) : array.error().message;
      if (!fault) continue;
      faults.push_back(std::move(*fault));
      are_faults_zero = are_faults_zero && array && is_zero(*array);
    }
    const bool move = hands_move(rotations);
    // Zeros of any shape are a hand at rest, which matters only next to one that moves.
    if (move || !are_faults_zero) {
      for (const std::string& fault : faults) warn("fingers ignored: " + fault);
    }
    if (!move) return;
    arrays_.hand_rotations = std::move(rotations);
    if (parts.size() == 1 && parts.front().count < kHandColumns) {
      const bool left = parts.front().first_joint == 0;
      warn(fmt::format("no {} next to {}: the fingers of the {} hand stay at rest",
                       left ? kRightHand : kLeftHand, parts.front().name, left ? "right" : "left"));
    }
  }

  // Adds the fingers of a part to `rotations`. Returns the fault of malformed ones.
  [[nodiscard]] std::optional<std::string> add_hand(const HandPart& part, const NpyArray& array,
                                                    std::vector<Eigen::Vector3d>& rotations) const {
    const auto frames = static_cast<std::size_t>(arrays_.frame_count);
    const std::size_t width = width_of(array.shape), joints = part.count / 3;
    // Principal components are not rotations.
    const bool fits = part.first > 0 ? width >= part.first + part.count : width == part.count;
    if (!fits || !array.is_number() || array.shape[0] != frames) {
      return fmt::format("expected {} of shape ({}, {}), found {}", part.name, frames, part.count,
                         shape_text(array.shape));
    }
    const std::vector<double> values = array.numbers();
    std::vector<Eigen::Vector3d> turns;
    turns.reserve(frames * joints);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const double* row = values.data() + frame * width + part.first;
      for (std::size_t joint = 0; joint < joints; ++joint) {
        turns.emplace_back(Eigen::Map<const Eigen::Vector3d>(row + 3 * joint));
      }
    }
    if (!std::ranges::all_of(turns, is_rotation)) {
      return fmt::format("{} has values that are not rotations in radians", part.name);
    }
    for (std::size_t i = 0; i < turns.size(); ++i) {
      rotations[i / joints * kSmplHandJointCount + part.first_joint + i % joints] = turns[i];
    }
    return std::nullopt;
  }

  static bool is_zero(const NpyArray& array) {
    return array.is_number() &&
           std::ranges::all_of(array.numbers(), [](double value) { return value == 0.0; });
  }

  static bool is_rotation(const Eigen::Vector3d& vector) {
    constexpr double kMost = 20.0;
    return vector.allFinite() && vector.cwiseAbs().maxCoeff() < kMost;
  }

  static bool hands_move(const std::vector<Eigen::Vector3d>& rotations) {
    constexpr double kStill = 1e-3;  // rad
    for (std::size_t i = kSmplHandJointCount; i < rotations.size(); ++i) {
      if ((rotations[i] - rotations[i % kSmplHandJointCount]).norm() > kStill) return true;
    }
    return false;
  }

  Result<void> read_translations() {
    const char* name = translations_of(file_, whole_poses_);
    TRY_ASSIGN(const auto trans, read_table(name, {3}));
    if (trans.rows != static_cast<std::size_t>(arrays_.frame_count)) {
      return other_length(name, trans, "the rotations have", arrays_.frame_count);
    }
    TRY_ASSIGN(const auto scale, read_scaling(name));
    for (std::size_t row = 0; row < trans.rows; ++row) {
      arrays_.translations.push_back(trans.vector(row, 0) / scale);
      if (arrays_.translations.back().allFinite()) continue;
      return file_.array_failure(name, fmt::format("too large for its scale in frame {}", row));
    }
    return {};
  }

  // AIST++: factor between the size of the body and that of the model; the body is in its own unit.
  Result<double> read_scaling(std::string_view translations) const {
    constexpr const char* kName = "smpl_scaling";
    if (translations != "smpl_trans" || !file_.has(kName)) return 1.0;
    TRY_ASSIGN(const auto array, file_.read(kName));
    const auto values = array.is_number() ? array.numbers() : std::vector<double>();
    if (values.size() == 1 && std::isfinite(values[0]) && values[0] > 0.0) return values[0];
    return file_.array_failure(kName, "expected one number above 0");
  }

  Failure no_motion() const {
    std::string hint;
    if (file_.has("v_template")) {
      hint = "this is a body model, not a motion: give it as " OPTION("smpl-model");
    } else if (file_.has("betas") && !file_.has("global_orient") && !file_.has("body_pose")) {
      hint =
          "AMASS keeps only the body in shape.npz and *_stagei.npz; motions are *_poses.npz and "
          "*_stageii.npz";
    }
    return file_.file_failure(
        "expected an SMPL motion with the arrays \"poses\", or \"root_orient\" and \"pose_body\", "
        "or joint positions as \"joint_positions\"; found " +
            (file_.names().empty() ? "no arrays at all" : list_names(file_.names(), 20)),
        hint);
  }

  Result<void> read_rate(std::optional<double> source_fps) {
    TRY_ASSIGN(const auto stated, read_motion_rate(file_, source_fps));
    if (!stated.rate && !kind_.fps) return no_motion_rate(file_);
    arrays_.rate = stated.rate ? *stated.rate : frame_rate_from_fps(*kind_.fps);
    for (const Warning& warning : stated.warnings) arrays_.warnings.push_back(warning);
    if (!stated.rate && !kind_.fps_reason.empty()) warn(kind_.fps_reason);
    return {};
  }

  Result<void> read_betas() {
    if (!file_.has("betas")) {
      // The file's own bones need no shape.
      if (!kind_.has_no_betas && !file_.has("rest_offsets")) {
        warn("no betas: assuming the average body shape");
      }
      return {};
    }
    TRY_ASSIGN(const auto array, file_.read("betas"));
    const std::vector<std::size_t>& shape = array.shape;
    if (!array.is_number() || shape.empty() || shape.size() > 2) {
      return file_.array_failure("betas", "expected a row of numbers, found " +
                                              std::string(array.is_text() ? "text of " : "") +
                                              "shape " + shape_text(shape));
    }
    const auto frames = static_cast<std::size_t>(arrays_.frame_count);
    if (shape.size() == 2 && shape[0] > 1 && shape[0] != frames) {
      return file_.array_failure(
          "betas", fmt::format("it has {} rows, the rotations have {}", shape[0], frames));
    }
    const std::vector<double> values = array.numbers();
    const auto bad = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
    if (bad != values.end()) {
      return file_.array_failure(
          "betas", "number " + std::to_string(bad - values.begin()) + " is not finite");
    }
    if (values.empty()) {
      warn("no betas: assuming the average body shape");
      return {};
    }
    // Fits to video give one row per frame, but a body has one shape.
    const auto width = static_cast<std::ptrdiff_t>(shape.back());
    arrays_.betas.assign(values.begin(), values.begin() + width);
    for (auto row = values.begin(); row != values.end(); row += width) {
      if (std::equal(row, row + width, values.begin())) continue;
      warn("betas vary over time: using the first frame");
      break;
    }
    return {};
  }

  Result<void> read_gender() {
    if (!file_.has("gender")) {
      arrays_.gender = kind_.gender;
      if (kind_.gender.empty()) warn("no gender");
      return {};
    }
    TRY_ASSIGN(const auto type, file_.type_of("gender"));
    if (is_python_object(type)) {
      warn("gender is a Python object, which is not unpickled: ignored");
      return {};
    }
    TRY_ASSIGN(auto word, read_word("gender"));
    constexpr std::array<std::string_view, 3> kGenders = {"neutral", "female", "male"};
    if (std::ranges::find(kGenders, word) == kGenders.end()) {
      warn("gender is not neutral, female or male: ignored");
      return {};
    }
    arrays_.gender = std::move(word);
    return {};
  }

  static bool is_python_object(const std::string& type) {
    return type.find('O') != std::string::npos;
  }

  // Reads the first element of a text array in lower case. Returns an empty string for other
  // arrays; only a damaged file is an error.
  Result<std::string> read_word(const char* name) const {
    TRY_ASSIGN(const auto type, file_.type_of(name));
    // An unexpected Python object is no reason to reject the motion.
    if (is_python_object(type)) return std::string();
    TRY_ASSIGN(const auto array, file_.read(name));
    if (!array.is_text() || array.element_count() == 0) return std::string();
    std::string word = array.texts().front();
    // Strip the str() form of Python bytes.
    if (word.starts_with("b'") && word.ends_with('\'')) word = word.substr(2, word.size() - 3);
    return lower_case(word);
  }

  Result<void> read_family() {
    arrays_.family = kind_.family;
    if (file_.has("surface_model_type")) {
      TRY_ASSIGN(const auto word, read_word("surface_model_type"));
      if (word.starts_with("smplx")) arrays_.family = SmplFamily::kSmplx;
      if (word == "smpl" || word == "smplh") arrays_.family = SmplFamily::kSmpl;
      if (arrays_.family != SmplFamily::kUnknown) return {};
    }
    if (pose_width_ == kSmplColumns || pose_width_ == kSmplhColumns) {
      arrays_.family = SmplFamily::kSmpl;
    }
    if (pose_width_ == kSmplxColumns || file_.has("pose_jaw") || file_.has("pose_eye")) {
      arrays_.family = SmplFamily::kSmplx;
    }
    return {};
  }

  // Reads the joint offsets to their parents in the zero pose, which OMOMO's sequences contain.
  Result<void> read_rest_offsets() {
    constexpr const char* kName = "rest_offsets";
    arrays_.body = kind_.body;
    if (!file_.has(kName)) return {};
    TRY_ASSIGN(const auto array, file_.read(kName));
    const bool fits = array.is_number() && array.shape.size() == 2 && array.shape[1] == 3 &&
                      array.shape[0] >= kSmplJointCount && array.shape[0] <= kSmplxColumns / 3;
    if (!fits) {
      return file_.array_failure(
          kName, fmt::format("expected numbers of shape ({} or more, 3), found {}", kSmplJointCount,
                             shape_text(array.shape)));
    }
    const std::vector<double> numbers = array.numbers();
    std::vector<Eigen::Vector3d> offsets;
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      offsets.emplace_back(Eigen::Map<const Eigen::Vector3d>(numbers.data() + 3 * joint));
    }
    arrays_.body = smpl_rest_body_of_offsets(offsets);
    if (arrays_.body) return {};
    return file_.array_failure(kName,
                               "the offsets do not form a body: expected joint offsets from "
                               "parents in metres, y up, x left");
  }

  void warn(std::string message) { arrays_.warnings.push_back({0, 0, std::move(message)}); }

  const ArraySource& file_;
  const MotionKind& kind_;
  MotionArrays arrays_;
  const char* whole_poses_ = nullptr;  // An entry of kWholePoses, if it was read.
  std::size_t pose_width_ = 0;         // Columns of `poses`; 0 without them.
};

}  // namespace

bool has_motion(const ArraySource& file) {
  return parted_poses(file) != nullptr || first_of(file, kWholePoses) != nullptr;
}

bool has_amass_names(const ArraySource& file) {
  const bool parted = file.has(kPartedPoses.front().first) && file.has(kPartedPoses.front().second);
  return (parted || file.has(kWholePoses.front())) && file.has(kTranslations.front());
}

Result<MotionArrays> read_motion_arrays(const ArraySource& file, const MotionKind& kind,
                                        std::optional<double> source_fps) {
  return MotionReader(file, kind).read(source_fps);
}

}  // namespace retarget
