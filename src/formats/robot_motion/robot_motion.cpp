#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/robot_motion/motion_writers.h"
#include "formats/robot_motion/raw_motion.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Tolerance on the length of a quaternion.
constexpr double kUnitTolerance = 0.05;

// Converts a motion from the units and orders of its file to the robot's.
class MotionInterpreter {
 public:
  MotionInterpreter(RawMotion& raw, std::shared_ptr<const Robot> robot, const std::string& file,
                    const ReadMotionOptions& options)
      : raw_(raw), robot_(std::move(robot)), file_(file), options_(options) {}

  Result<RobotMotion> interpret() {
    if (raw_.joint_indices.empty()) {
      TRY_ASSIGN(raw_.joint_indices,
                 joints_by_count(*robot_, raw_.joint_count, raw_, file_, options_.variant));
    }
    TRY(check_numbers());
    const bool assumes_metres =
        !options_.metres_per_unit && (!raw_.metres_per_unit || raw_.units_of_format);
    TRY(find_units(*robot_, file_, options_, raw_));
    take_euler();
    TRY(check_rotations());
    note_missing_joints();
    RobotMotion motion;
    motion.format = raw_.format;
    motion.rate_known = options_.rate || raw_.rate;
    motion.clip = RobotClip(robot_, rate(), static_cast<int>(raw_.frames));
    take_joints(motion.clip);
    TRY_ASSIGN(const auto order, find_order(motion.clip));
    take_rotations(motion.clip, order);
    // The user's choice of a format also serves files of other robots, whose bodies differ.
    if (options_.format != raw_.format) {
      TRY(check_body_places(motion.clip, raw_, order, file_));
    }
    if (assumes_metres) {
      TRY(check_assumed_metres(motion.clip, file_, raw_));
    }
    motion.contacts = std::move(raw_.contacts);
    motion.notes = std::move(raw_.notes);
    motion.warnings = std::move(raw_.warnings);
    return motion;
  }

 private:
  [[nodiscard]] FrameRate default_rate() const {
    constexpr FrameRate kUsualRate{30, 1}, kSomaRate{120, 1};
    return options_.default_rate.value_or(raw_.format == MotionFormat::kCsvSoma ? kSomaRate
                                                                                : kUsualRate);
  }

  [[nodiscard]] FrameRate rate() const {
    return options_.rate.value_or(raw_.rate.value_or(default_rate()));
  }

  [[nodiscard]] bool is_csv() const { return format_ending(raw_.format) == ".csv"; }

  Result<void> check_numbers() {
    constexpr double kMaxMagnitude = 1e6;
    // False for NaN, too.
    const auto sound = [](double value) { return std::abs(value) <= kMaxMagnitude; };
    if (!std::ranges::all_of(raw_.position, sound) || !std::ranges::all_of(raw_.joints, sound)) {
      return input_failure(file_, "the motion has a number that is not finite, or beyond 1e6");
    }
    if (!std::ranges::all_of(raw_.euler, sound)) {
      return input_failure(file_, "the root's angles are not finite, or beyond 1e6");
    }
    return {};
  }

  Result<void> check_rotations() {
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      double square = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        square += raw_.rotation[4 * frame + i] * raw_.rotation[4 * frame + i];
      }
      const double length = std::sqrt(square);
      // Negated comparison: also rejects NaN.
      if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
        return input_failure(file_,
                             "the root quaternion in frame " + std::to_string(frame) +
                                 " has length " + number_text(length, 3) + ", expected 1",
                             "the columns are x y z, then the quaternion, then the joints");
      }
    }
    return {};
  }

  // Converts Euler angles to quaternions once their unit is known.
  void take_euler() {
    const double unit = raw_.degrees.value_or(false) ? kRadiansPerDegree : 1.0;
    for (std::size_t i = 0; i + 3 <= raw_.euler.size(); i += 3) {
      const Eigen::Quaterniond q = exp_so3(unit * raw_.euler[i + 2] * Eigen::Vector3d::UnitZ()) *
                                   exp_so3(unit * raw_.euler[i + 1] * Eigen::Vector3d::UnitY()) *
                                   exp_so3(unit * raw_.euler[i] * Eigen::Vector3d::UnitX());
      raw_.rotation.insert(raw_.rotation.end(), {q.x(), q.y(), q.z(), q.w()});
    }
  }

  // Reports joints of the robot, or of the variant given for the file, that the file lacks.
  void note_missing_joints() {
    std::vector<std::string> missing;
    for (const int joint : output_joints_of(*robot_, options_.variant)) {
      if (std::ranges::find(raw_.joint_indices, joint) == raw_.joint_indices.end()) {
        missing.push_back(robot_->joints()[joint].name);
      }
    }
    if (missing.empty()) return;
    constexpr std::size_t kShown = 6;
    const std::string note =
        std::to_string(missing.size()) + " of the robot's " +
        std::to_string(robot_->output_joints().size()) +
        " joints are not in the file and remain in its zero pose: " + list_names(missing, kShown);
    // PBHC's pickles lack joints by design, and a user who names a variant expects it: note only.
    (is_csv() && options_.variant.empty() ? raw_.warnings : raw_.notes).push_back(note);
  }

  [[nodiscard]] bool is_hinge(std::size_t column) const {
    return robot_->joints()[raw_.joint_indices[column]].type == RobotJoint::Type::kHinge;
  }

  void take_joints(RobotClip& clip) const {
    const double unit = *raw_.metres_per_unit;
    const double angle = raw_.degrees.value_or(false) ? kRadiansPerDegree : 1.0;
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      const auto qpos = clip.qpos(static_cast<int>(frame));
      for (std::size_t i = 0; i < 3; ++i) qpos[i] = unit * raw_.position[3 * frame + i];
      for (std::size_t j = 0; j < raw_.joint_count; ++j) {
        const RobotJoint& joint = robot_->joints()[raw_.joint_indices[j]];
        // Joints that the robot's variant locks keep their locked position.
        if (robot_->variant().locked.contains(joint.name)) continue;
        qpos[joint.qpos_address] =
            (is_hinge(j) ? angle : unit) * raw_.joints[frame * raw_.joint_count + j];
      }
    }
  }

  // A fixed base has a known rotation; otherwise the motion provides the evidence.
  [[nodiscard]] OrderGuess guess_of_order(const RobotClip& clip) const {
    if (robot_->fixed_base()) {
      OrderGuess guess = order_of_fixed_base(*robot_, raw_);
      if (guess.order) return guess;
    }
    return guess_order(weigh_orders(clip, raw_), raw_.usual);
  }

  // The order of a CSV whose motion does not decide it: the usual one, unless the evidence is
  // contradictory.
  Result<QuaternionOrder> uncertain_order(const OrderGuess& guess) {
    const std::string usual = raw_.usual == QuaternionOrder::kXyzw ? "xyzw" : "wxyz";
    if (guess.contradictory) {
      return input_failure(file_, "cannot infer the order of the root quaternion: " + guess.reason,
                           "choose with " OPTION("source-quat"));
    }
    raw_.warnings.push_back(
        "xyzw and wxyz are equally plausible orders of the root quaternion; it is read as " +
        usual + ", the usual order; " OPTION("source-quat") " sets another one");
    return raw_.usual;
  }

  Result<QuaternionOrder> find_order(const RobotClip& clip) {
    if (raw_.order) {
      if (options_.quaternion && is_csv()) {
        raw_.notes.emplace_back("the header specifies the quaternion order");
      }
      return *raw_.order;
    }
    if (options_.quaternion) return *options_.quaternion;
    const OrderGuess guess = guess_of_order(clip);
    if (!guess.order) {
      if (!is_csv()) return raw_.usual;
      return uncertain_order(guess);
    }
    if (is_csv() || *guess.order != raw_.usual) {
      raw_.notes.push_back(std::string("quaternion ") +
                           (*guess.order == QuaternionOrder::kXyzw ? "xyzw: " : "wxyz: ") +
                           guess.reason);
    }
    return *guess.order;
  }

  void take_rotations(RobotClip& clip, QuaternionOrder order) const {
    Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      const double* q = raw_.rotation.data() + 4 * frame;
      Eigen::Quaterniond rotation = order == QuaternionOrder::kWxyz
                                        ? Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                                        : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
      rotation.normalize();
      if (frame > 0) align_sign(before.coeffs(), rotation.coeffs());
      before = rotation;
      set_root_rotation(clip.qpos(static_cast<int>(frame)), rotation);
    }
  }

  RawMotion& raw_;
  std::shared_ptr<const Robot> robot_;
  const std::string& file_;
  const ReadMotionOptions& options_;
};

}  // namespace

std::vector<int> output_joints_of(const Robot& robot, const std::string& name) {
  std::vector<int> joints = robot.output_joints();
  for (const RobotVariant& variant : robot.profile().variants) {
    if (variant.name != name) continue;
    std::erase_if(joints,
                  [&](int joint) { return variant.locked.contains(robot.joints()[joint].name); });
  }
  return joints;
}

std::vector<std::string> variants_by_count(const Robot& robot, std::size_t count,
                                           MotionFormat format, const std::string& variant) {
  std::vector<std::string> fitting;
  for (const RobotVariant& each : robot.profile().variants) {
    if (!variant.empty() && each.name != variant) continue;
    if (output_joints_of(robot, each.name).size() == count) fitting.push_back(each.name);
  }
  if (format == MotionFormat::kPklPbhc && fitting.size() > 1) {
    std::erase_if(fitting, [](const std::string& name) { return !name.ends_with("pbhc"); });
  }
  return fitting;
}

Result<std::vector<int>> joints_by_count(const Robot& robot, std::size_t count,
                                         const RawMotion& raw, const std::string& file,
                                         const std::string& variant) {
  const bool whole = variant.empty() || output_joints_of(robot, variant) == robot.output_joints();
  if (whole && robot.output_joints().size() == count) return robot.output_joints();
  const std::vector<std::string> fitting = variants_by_count(robot, count, raw.format, variant);
  if (fitting.size() == 1) return output_joints_of(robot, fitting.front());
  if (fitting.empty()) {
    std::vector<std::string> known;
    for (const RobotVariant& each : robot.profile().variants) known.push_back(each.name);
    return input_failure(file,
                         fmt::format("the motion has {} joints, and neither the robot {} nor any "
                                     "of its variants has that many",
                                     count, robot.name()),
                         known.empty() ? "" : "its variants are " + list_names(known));
  }
  return input_failure(
      file, std::to_string(count) + " joints may be those of the variants " + list_names(fitting),
      OPTION("source-dof") " chooses one");
}

std::vector<int> joints_among(const Robot& robot, const Robot& variant,
                              const std::vector<int>& joints) {
  std::vector<int> found;
  for (const int joint : joints) {
    if (const auto own = robot.find_joint(variant.joints()[joint].name)) found.push_back(*own);
  }
  return found;
}

Result<RobotMotion> interpret_motion(RawMotion& raw, const std::shared_ptr<const Robot>& robot,
                                     const std::string& file, const ReadMotionOptions& options) {
  return MotionInterpreter(raw, robot, file, options).interpret();
}

// Motions of a robot's variants, the information that formats lose, and contacts of the feet.

RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot) {
  RobotClip changed(std::move(robot), clip.rate(), clip.frame_count());
  const Robot& other = changed.robot();
  // Addresses of each joint in both configurations, whose models may differ.
  std::vector<std::pair<int, int>> addresses;
  for (const int index : other.output_joints()) {
    const RobotJoint& joint = other.joints()[index];
    const auto own = clip.robot().find_joint(joint.name);
    if (!own) continue;
    addresses.emplace_back(clip.robot().joints()[*own].qpos_address, joint.qpos_address);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto from = clip.qpos(frame);
    const auto to = changed.qpos(frame);
    for (std::size_t i = 0; i < 7; ++i) to[i] = from[i];
    for (const auto& [source, target] : addresses) to[target] = from[source];
  }
  return changed;
}

Result<std::shared_ptr<const Robot>> pbhc_robot(const std::shared_ptr<const Robot>& robot) {
  if (!robot->variant().name.empty()) return robot;
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.name.ends_with("pbhc")) return robot_variant(robot, variant.name);
  }
  return robot;
}

std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant) {
  constexpr double kEpsilon = 1e-6;
  constexpr std::size_t kShown = 6;
  std::vector<std::string> lost;
  double largest = 0.0;
  std::string worst;
  for (const auto& [name, held] : variant.variant().locked) {
    const auto joint = clip.robot().find_joint(name);
    if (!joint) continue;
    const int address = clip.robot().joints()[*joint].qpos_address;
    double away = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      away = std::max(away, std::abs(clip.qpos(frame)[address] - held));
    }
    if (away > kEpsilon) lost.push_back(name);
    if (away <= largest) continue;
    largest = away;
    worst = name;
  }
  if (lost.empty()) return std::nullopt;
  return count_text(lost.size(), "joint") + " with movement would be locked, losing up to " +
         number_text(largest, 3) + " rad (" + worst + "): " + list_names(lost, kShown);
}

std::vector<std::string> soma_csv_losses(const RobotClip& /*motion*/, const FrameRate& rate) {
  if (soma_csv_tells(rate)) return {};
  return {"csv-soma stores no rate: its readers assume 120 fps, this motion has " + to_text(rate) +
          "; " OPTION("fps") " 120 writes the expected rate"};
}

std::vector<std::string> pbhc_losses(const RobotClip& motion, const FrameRate& /*rate*/) {
  const auto robot = pbhc_robot(motion.shared_robot());
  if (!robot || *robot == motion.shared_robot()) return {};
  const auto lost = lost_joints(motion, **robot);
  if (!lost) return {};
  const std::string& variant = (*robot)->variant().name;
  return {"pkl-pbhc has the joints of the variant " + variant + ": " + *lost +
          "; " OPTION("dof") " " + variant + " omits them, and pkl-motion-lib stores all joints"};
}

namespace {

// The product of a frame number and the terms of two rates can exceed 64 bits.
__extension__ using WideInt = __int128;

}  // namespace

FootContacts resample_contacts(const FootContacts& contacts, const FrameRate& from,
                               const FrameRate& to, int frames) {
  const WideInt numerator = WideInt{from.frames} * to.seconds;
  const WideInt denominator = WideInt{from.seconds} * to.frames;
  const int last = contacts.frame_count() - 1;
  FootContacts resampled;
  if (last < 0) return resampled;
  resampled.planted.reserve(kContactNames.size() * static_cast<std::size_t>(frames));
  for (WideInt i = 0; i < frames; ++i) {
    // The nearest frame; the earlier one if two are equally near.
    const WideInt nearest = (2 * i * numerator + denominator - 1) / (2 * denominator);
    const auto frame = static_cast<std::ptrdiff_t>(std::min<WideInt>(nearest, last));
    const auto begin =
        contacts.planted.begin() + static_cast<std::ptrdiff_t>(kContactNames.size()) * frame;
    resampled.planted.insert(resampled.planted.end(), begin,
                             begin + static_cast<std::ptrdiff_t>(kContactNames.size()));
  }
  return resampled;
}

}  // namespace retarget
