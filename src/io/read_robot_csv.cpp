#include "retarget/io/read_robot_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "io/csv_cells.h"
#include "retarget/base/file.h"
#include "retarget/base/suggest.h"

namespace retarget {
namespace {

// metres or radians beyond which a number is no motion of a robot
constexpr double kLargest = 1e6;
// a quaternion of this length has no direction
constexpr double kNoLength = 1e-6;
constexpr std::size_t kRootColumns = 7;

class CsvReader {
 public:
  CsvReader(std::shared_ptr<const Robot> robot, std::string file, QuaternionOrder order)
      : robot_(std::move(robot)), file_(std::move(file)), order_(order) {
    for (const int joint : robot_->output_joints()) {
      addresses_.push_back(robot_->joints()[joint].qpos_address);
    }
  }

  Result<RobotClip> read(std::string_view text, const FrameRate& rate);

 private:
  Result<void> read_line(std::string_view line);
  Result<void> read_header();
  Result<void> read_row();
  Result<void> check_width();
  void take_row(std::span<const double> row);
  [[nodiscard]] Failure fault(std::size_t column, std::string message, std::string hint = {}) const;

  std::shared_ptr<const Robot> robot_;
  std::string file_;
  QuaternionOrder order_;
  std::vector<int> addresses_;  // into a configuration, by joint column
  std::size_t line_ = 0;        // from 1
  bool begun_ = false;          // a line with cells was read
  std::optional<std::size_t> width_;
  std::vector<CsvCell> cells_;
  std::vector<double> row_;
  double previous_first_ = 0.0;
  int frames_ = 0;
  std::vector<double> qpos_;  // frame-major
};

Failure CsvReader::fault(std::size_t column, std::string message, std::string hint) const {
  return failure({.kind = ErrorKind::kInput,
                  .file = file_,
                  .line = line_,
                  .column = column + 1,
                  .message = std::move(message),
                  .hint = std::move(hint)});
}

Result<RobotClip> CsvReader::read(std::string_view text, const FrameRate& rate) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    ++line_;
    if (auto done = read_line(text.substr(0, end)); !done) return failure(done.error());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (frames_ == 0) return input_failure(file_, "the file holds no frames");
  RobotClip clip(robot_, rate, frames_);
  const auto size = static_cast<std::size_t>(robot_->configuration_size());
  for (int frame = 0; frame < frames_; ++frame) {
    const auto from = qpos_.begin() + static_cast<std::ptrdiff_t>(frame * size);
    std::copy(from, from + static_cast<std::ptrdiff_t>(size), clip.qpos(frame).begin());
  }
  return clip;
}

Result<void> CsvReader::read_line(std::string_view line) {
  split_cells(line, cells_);
  if (cells_.empty() || cells_.front().text.starts_with('#')) return {};
  const bool first = !std::exchange(begun_, true);
  if (first && !number_of_cell(cells_.front().text)) return read_header();
  return read_row();
}

// a header that names joints says which column is which; any other one is passed over
Result<void> CsvReader::read_header() {
  std::vector<int> addresses;
  std::vector<std::size_t> unknown;
  const std::size_t joints = addresses_.size();
  const std::size_t extra = cells_.size() > kRootColumns + joints ? 1 : 0;
  for (std::size_t i = kRootColumns + extra; i < cells_.size(); ++i) {
    const auto joint = robot_->find_joint(cells_[i].text);
    if (joint) {
      addresses.push_back(robot_->joints()[*joint].qpos_address);
    } else {
      unknown.push_back(i);
    }
  }
  if (addresses.empty()) return {};
  if (!unknown.empty()) {
    const CsvCell& cell = cells_[unknown.front()];
    return fault(cell.column, "the header names \"" + std::string(cell.text) +
                                  "\", which is no joint of the robot " + robot_->name() +
                                  did_you_mean(cell.text, robot_->joint_names()));
  }
  std::vector<int> sorted = addresses;
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end()) {
    return fault(cells_.front().column, "the header names a joint twice");
  }
  addresses_ = std::move(addresses);
  const std::string_view fourth = cells_[3 + extra].text;
  if (fourth.ends_with("qw") || fourth == "w") order_ = QuaternionOrder::kWxyz;
  return {};
}

Result<void> CsvReader::check_width() {
  const std::size_t expected = kRootColumns + addresses_.size();
  const std::size_t found = cells_.size();
  if (!width_ && (found == expected || found == expected + 1)) width_ = found;
  if (width_ == found) return {};
  const std::string has = std::to_string(found) + (found == 1 ? " column" : " columns");
  if (width_) {
    return fault(0, "this line has " + has + ", those before it " + std::to_string(*width_));
  }
  return fault(0, "this line has " + has + ", the robot " + robot_->name() + " needs " +
                      std::to_string(expected) + ": 7 of the root and " +
                      std::to_string(addresses_.size()) + " joints");
}

Result<void> CsvReader::read_row() {
  if (auto checked = check_width(); !checked) return checked;
  row_.clear();
  for (const CsvCell& cell : cells_) {
    const auto value = number_of_cell(cell.text);
    if (!value) {
      const std::string found(cell.text.substr(0, 40));
      return fault(cell.column, "expected a number, found \"" + found + "\"");
    }
    // written so that NaN is caught
    if (!(std::abs(*value) <= kLargest)) {
      return fault(cell.column,
                   "the number " + std::string(cell.text.substr(0, 40)) + " is out of range");
    }
    row_.push_back(*value);
  }
  const bool numbered = row_.size() > kRootColumns + addresses_.size();
  if (numbered) {
    if (frames_ > 0 && row_[0] <= previous_first_) {
      return fault(cells_[0].column,
                   "one column too many, and the first is no frame number: it does not grow");
    }
    previous_first_ = row_[0];
  }
  const std::span<const double> row = std::span<const double>(row_).subspan(numbered ? 1 : 0);
  const Eigen::Vector4d quaternion(row[3], row[4], row[5], row[6]);
  if (quaternion.norm() < kNoLength) {
    return fault(cells_[numbered ? 4 : 3].column, "the root's quaternion is zero");
  }
  take_row(row);
  return {};
}

void CsvReader::take_row(std::span<const double> row) {
  std::vector<double> qpos = robot_->zero_configuration();
  for (std::size_t i = 0; i < 3; ++i) qpos[i] = row[i];
  Eigen::Quaterniond rotation = order_ == QuaternionOrder::kWxyz
                                    ? Eigen::Quaterniond(row[3], row[4], row[5], row[6])
                                    : Eigen::Quaterniond(row[6], row[3], row[4], row[5]);
  rotation.normalize();
  if (frames_ > 0) {
    const double* before = qpos_.data() + qpos_.size() - qpos.size() + 3;
    const double dot = rotation.w() * before[0] + rotation.x() * before[1] +
                       rotation.y() * before[2] + rotation.z() * before[3];
    if (dot < 0.0) rotation.coeffs() = -rotation.coeffs();
  }
  qpos[3] = rotation.w();
  qpos[4] = rotation.x();
  qpos[5] = rotation.y();
  qpos[6] = rotation.z();
  for (std::size_t i = 0; i < addresses_.size(); ++i) qpos[addresses_[i]] = row[kRootColumns + i];
  qpos_.insert(qpos_.end(), qpos.begin(), qpos.end());
  ++frames_;
}

}  // namespace

Result<RobotClip> parse_robot_csv(std::string_view text, const std::shared_ptr<const Robot>& robot,
                                  const FrameRate& rate, const std::string& file,
                                  const ReadRobotCsvOptions& options) {
  return CsvReader(robot, file, options.quaternion_order).read(text, rate);
}

Result<RobotClip> load_robot_csv(const std::string& path, const std::shared_ptr<const Robot>& robot,
                                 const FrameRate& rate, const ReadRobotCsvOptions& options) {
  const auto content = read_file(path);
  if (!content) return failure(content.error());
  return parse_robot_csv(content->view(), robot, rate, path == "-" ? "standard input" : path,
                         options);
}

}  // namespace retarget
