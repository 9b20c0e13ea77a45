#include "retarget/motion_io.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/step_bounds.h"
#include "base/option_name.h"
#include "formats/robot_motion/motion_writers.h"
#include "formats/robot_motion/raw_motion.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// The largest finite double has 309 digits before the point.
constexpr std::size_t kMaxNumberLength = 340;

constexpr int kMaxDigits = 17;

constexpr double kDegreesPerRadian = PrintedUnits::kDegrees;
constexpr double kCentimetresPerMetre = PrintedUnits::kCentimetres;
constexpr std::int64_t kSomaFramesASecond = 120;
// A quaternion shorter than this has no direction.
constexpr double kNoLength = 1e-6;

// Column names in output order. Units other than metres and radians are appended, except in SOMA's
// files, whose units are fixed.
std::vector<std::string> column_names(const Robot& robot, const RobotCsvOptions& options) {
  const std::string length = options.centimetres && !options.euler ? "(cm)" : "";
  const std::string angle = options.degrees && !options.euler ? "(deg)" : "";
  std::vector<std::string> names;
  if (options.frame_column) names.emplace_back("Frame");
  const std::string position = options.euler ? "root_translate" : "root_";
  const std::array<const char*, 3> axes = options.euler ? std::array<const char*, 3>{"X", "Y", "Z"}
                                                        : std::array<const char*, 3>{"x", "y", "z"};
  for (const char* axis : axes) names.push_back(position + axis + length);
  const bool w_first = options.quaternion_order == QuaternionOrder::kWxyz;
  if (!options.euler && w_first) names.emplace_back("root_qw");
  for (const char* axis : axes) {
    names.push_back((options.euler ? "root_rotate" : "root_q") + std::string(axis));
  }
  if (!options.euler && !w_first) names.emplace_back("root_qw");
  for (const int joint : robot.output_joints()) {
    const RobotJoint& of = robot.joints()[joint];
    const std::string& unit = of.type == RobotJoint::Type::kSlide ? length : angle;
    names.push_back(of.name + (options.euler ? "_dof" : "") + unit);
  }
  return names;
}

// Quotes a name that contains a quote or a delimiter of any CSV.
std::string quoted_cell(const std::string& name) {
  if (name.find_first_of("\",; \t") == std::string::npos) return name;
  std::string cell = "\"";
  for (const char letter : name)
    cell += letter == '"' ? std::string(2, letter) : std::string(1, letter);
  return cell + '"';
}

std::string header_line(const Robot& robot, const RobotCsvOptions& options) {
  std::string line;
  for (const std::string& name : column_names(robot, options)) {
    if (!line.empty()) line += options.delimiter;
    line += quoted_cell(name);
  }
  return line + '\n';
}

// Angles a, b, c with R = Rz(c) Ry(b) Rx(a).
std::array<double, 3> fixed_axis_angles(double w, double x, double y, double z) {
  // In gimbal lock only a - c or a + c is determined; c is set to 0.
  constexpr double kPole = 1.0 - 1e-12;
  const double sine = 2.0 * (w * y - z * x) / (w * w + x * x + y * y + z * z);
  if (std::abs(sine) >= kPole) {
    const double quarter = portable::atan2(1.0, 0.0);
    return {2.0 * portable::atan2(x, w), sine > 0.0 ? quarter : -quarter, 0.0};
  }
  return {portable::atan2(2.0 * (w * x + y * z), w * w - x * x - y * y + z * z),
          portable::atan2(sine, std::sqrt(1.0 - sine * sine)),
          portable::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)};
}

// A value that rounds to zero is written without a sign, to avoid "-0.000000".
void append_number(std::string& text, double value, int precision) {
  std::array<char, kMaxNumberLength> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::fixed, precision);
  std::string_view number(digits.data(), end - digits.data());
  if (number.starts_with('-') && number.find_first_of("123456789") == std::string_view::npos) {
    number.remove_prefix(1);
  }
  text += number;
}

}  // namespace

bool soma_csv_tells(const FrameRate& rate) {
  return rate.seconds == 1 && kSomaFramesASecond % rate.frames == 0;
}

RobotCsvOptions soma_csv_options(const FrameRate& rate, int precision) {
  RobotCsvOptions options;
  if (soma_csv_tells(rate)) options.frame_step = static_cast<int>(kSomaFramesASecond / rate.frames);
  options.precision = precision;
  options.header = true;
  options.frame_column = true;
  options.degrees = true;
  options.centimetres = true;
  options.euler = true;
  return options;
}

RobotCsvFormatter::RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options)
    : options_(options), header_(options.header ? header_line(robot, options) : std::string()) {
  options_.precision = std::clamp(options.precision, 0, kMaxDigits);
  const double length = options.centimetres ? kCentimetresPerMetre : 1.0;
  const double angle = options.degrees ? kDegreesPerRadian : 1.0;
  position_ = {{0, length}, {1, length}, {2, length}};
  rotation_ = {{4, 1.0}, {5, 1.0}, {6, 1.0}};
  const bool w_first = options.quaternion_order == QuaternionOrder::kWxyz;
  rotation_.insert(w_first ? rotation_.begin() : rotation_.end(), {3, 1.0});
  for (const int index : robot.output_joints()) {
    const RobotJoint& joint = robot.joints()[index];
    joints_.push_back(
        {joint.qpos_address, joint.type == RobotJoint::Type::kSlide ? length : angle});
  }
}

void RobotCsvFormatter::append_value(double value, std::string& text) const {
  text += options_.delimiter;
  append_number(text, value, options_.precision);
}

void RobotCsvFormatter::append_line(std::span<const double> qpos, std::string& text,
                                    int frame) const {
  const std::size_t begin = text.size();
  if (options_.frame_column) {
    text += options_.delimiter + std::to_string(std::int64_t{frame} * options_.frame_step);
  }
  for (const Column& column : position_) {
    append_value(column.factor * qpos[column.address], text);
  }
  if (options_.euler) {
    const double unit = options_.degrees ? kDegreesPerRadian : 1.0;
    for (const double angle : fixed_axis_angles(qpos[3], qpos[4], qpos[5], qpos[6])) {
      append_value(unit * angle, text);
    }
  } else {
    for (const Column& column : rotation_) append_value(qpos[column.address], text);
  }
  for (const Column& column : joints_) append_value(column.factor * qpos[column.address], text);
  text.erase(begin, 1);  // Remove the delimiter before the first number.
  text += '\n';
}

std::string format_robot_csv(const RobotClip& clip, const RobotCsvOptions& options) {
  const RobotCsvFormatter formatter(clip.robot(), options);
  std::string text = formatter.header();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    formatter.append_line(clip.qpos(frame), text, frame);
  }
  return text;
}

namespace {

// Reads numbers back that a CSV prints, with the arithmetic of the reader.
class PrintedNumbers {
 public:
  explicit PrintedNumbers(const RobotCsvOptions& options)
      : precision_(std::clamp(options.precision, 0, kMaxDigits)),
        length_(options.centimetres ? Unit{kCentimetresPerMetre, 0.01} : Unit{}),
        angle_(options.degrees ? Unit{kDegreesPerRadian, kRadiansPerDegree} : Unit{}) {}

  [[nodiscard]] double length(double metres) { return read_back(metres, length_); }
  [[nodiscard]] double angle(double radians) { return read_back(radians, angle_); }

  [[nodiscard]] Eigen::Quaterniond quaternion(std::span<const double> qpos) {
    return {read_back(qpos[3], {}), read_back(qpos[4], {}), read_back(qpos[5], {}),
            read_back(qpos[6], {})};
  }
  [[nodiscard]] Eigen::Quaterniond euler_angles(std::span<const double> qpos) {
    const auto [a, b, c] = fixed_axis_angles(qpos[3], qpos[4], qpos[5], qpos[6]);
    return exp_so3(angle(c) * Eigen::Vector3d::UnitZ()) *
           exp_so3(angle(b) * Eigen::Vector3d::UnitY()) *
           exp_so3(angle(a) * Eigen::Vector3d::UnitX());
  }

 private:
  // A unit of the file, and its inverse.
  struct Unit {
    double per_si = 1.0;
    double in_si = 1.0;
  };

  double read_back(double value, const Unit& unit) {
    text_.clear();
    append_number(text_, unit.per_si * value, precision_);
    double read = 0.0;
    std::from_chars(text_.data(), text_.data() + text_.size(), read);
    return unit.in_si * read;
  }

  int precision_;
  Unit length_, angle_;
  std::string text_;
};

}  // namespace

Result<RobotClip> printed_clip(const RobotClip& clip, const RobotCsvOptions& options) {
  const Robot& robot = clip.robot();
  PrintedNumbers printed(options);
  RobotClip result(clip.shared_robot(), clip.rate(), clip.frame_count());
  const std::vector<double> zero = robot.zero_configuration();
  Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto from = clip.qpos(frame);
    const auto to = result.qpos(frame);
    std::ranges::copy(zero, to.begin());
    for (std::size_t i = 0; i < 3; ++i) to[i] = printed.length(from[i]);
    Eigen::Quaterniond turn = options.euler ? printed.euler_angles(from) : printed.quaternion(from);
    if (turn.norm() < kNoLength) {
      return run_failure("",
                         "the root quaternion in frame " + std::to_string(frame) +
                             " rounds to zero with " + std::to_string(options.precision) +
                             " digits",
                         "print more digits: " OPTION("precision"));
    }
    turn.normalize();
    if (frame > 0) align_sign(before.coeffs(), turn.coeffs());
    before = turn;
    set_root_rotation(to, turn);
    for (const int index : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[index];
      const bool slides = joint.type == RobotJoint::Type::kSlide;
      const double position = from[joint.qpos_address];
      to[joint.qpos_address] = slides ? printed.length(position) : printed.angle(position);
    }
  }
  return result;
}

MotionFiles write_csv(const RobotClip& clip, MotionFormat format,
                      const WriteMotionOptions& options) {
  const bool soma = format == MotionFormat::kCsvSoma;
  return one_file(format_robot_csv(
      clip, soma ? soma_csv_options(clip.rate(), options.csv.precision) : options.csv));
}

}  // namespace retarget
