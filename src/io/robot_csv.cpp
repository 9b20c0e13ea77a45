#include "retarget/io/robot_csv.h"

#include <array>
#include <charconv>
#include <string_view>

namespace retarget {
namespace {

// the largest finite double has 309 digits before the point
constexpr std::size_t kLongestNumber = 340;

// columns of a configuration in the order in which they are written
std::vector<int> column_order(const Robot& robot, QuaternionOrder order) {
  std::vector<int> columns = {0, 1, 2};
  const std::array<int, 4> xyzw = {4, 5, 6, 3};
  const std::array<int, 4> wxyz = {3, 4, 5, 6};
  const auto& quaternion = order == QuaternionOrder::kXyzw ? xyzw : wxyz;
  columns.insert(columns.end(), quaternion.begin(), quaternion.end());
  for (const int joint : robot.output_joints()) {
    columns.push_back(robot.joints()[joint].qpos_address);
  }
  return columns;
}

std::string header_line(const Robot& robot, const RobotCsvOptions& options) {
  std::vector<std::string> names = {"root_x", "root_y", "root_z"};
  const bool w_first = options.quaternion_order == QuaternionOrder::kWxyz;
  if (w_first) names.emplace_back("root_qw");
  for (const char* name : {"root_qx", "root_qy", "root_qz"}) names.emplace_back(name);
  if (!w_first) names.emplace_back("root_qw");
  for (const int joint : robot.output_joints()) names.push_back(robot.joints()[joint].name);
  std::string line;
  for (const std::string& name : names) {
    if (!line.empty()) line += options.delimiter;
    line += name;
  }
  return line + '\n';
}

// a value that rounds to zero has no sign: "-0.000000" is no number anyone expects
void append_number(std::string& text, double value, int precision) {
  std::array<char, kLongestNumber> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::fixed, precision);
  std::string_view number(digits.data(), end - digits.data());
  if (number.starts_with('-') && number.find_first_of("123456789") == std::string_view::npos) {
    number.remove_prefix(1);
  }
  text += number;
}

}  // namespace

RobotCsvFormatter::RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options)
    : options_(options),
      columns_(column_order(robot, options.quaternion_order)),
      header_(options.header ? header_line(robot, options) : std::string()) {}

void RobotCsvFormatter::append_line(std::span<const double> qpos, std::string& text) const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (i > 0) text += options_.delimiter;
    append_number(text, qpos[columns_[i]], options_.precision);
  }
  text += '\n';
}

std::string format_robot_csv(const RobotClip& clip, const RobotCsvOptions& options) {
  const RobotCsvFormatter formatter(clip.robot(), options);
  std::string text = formatter.header();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    formatter.append_line(clip.qpos(frame), text);
  }
  return text;
}

}  // namespace retarget
