#include "retarget/bvh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "base/try.h"
#include "formats/bvh/euler_angles.h"
#include "formats/bvh/read_bvh.h"
#include "formats/bvh/source_text.h"
#include "retarget/file.h"

namespace retarget {
namespace {

// Maximum angle in degrees between a rotation and the nearest one that the channels reach.
constexpr double kReachTolerance = 1e-7;
// Tolerance, relative to its size, for a translation with position channels for some axes only.
constexpr double kOffsetTolerance = 1e-9;
constexpr int kMaxDecimals = 17;

// Writes numbers in plain notation, because some readers do not support exponents.
class NumberWriter {
 public:
  explicit NumberWriter(std::optional<int> decimals) : decimals_(decimals) {}

  void append(std::string& text, double value) const {
    std::array<char, 400> buffer{};
    char* const begin = buffer.data();
    char* const end = begin + buffer.size();
    const std::to_chars_result result =
        decimals_ ? std::to_chars(begin, end, value, std::chars_format::fixed, *decimals_)
                  : std::to_chars(begin, end, value, std::chars_format::fixed);
    std::string_view number(begin, static_cast<std::size_t>(result.ptr - begin));
    const bool negative_zero =
        number.starts_with('-') && number.find_first_not_of("-0.") == std::string_view::npos;
    if (negative_zero) number.remove_prefix(1);
    text += number;
  }

 private:
  std::optional<int> decimals_;
};

class BvhWriter {
 public:
  BvhWriter(const Clip& clip, const BvhWriteOptions& options)
      : clip_(clip),
        skeleton_(clip.skeleton()),
        decimals_(options.decimals),
        numbers_(options.decimals) {}

  Result<std::string> write();

 private:
  // The rotation channels of a joint and their angles in the previous and the current frame.
  struct Turns {
    std::vector<int> axes;
    std::vector<double> before;
    std::vector<double> now;
  };

  Result<void> check() const;
  Result<void> check_joint(int joint) const;
  Result<void> write_hierarchy();
  void write_joint(int joint, int depth);
  void write_block_end(int depth);
  void write_offset(const Eigen::Vector3d& offset, int depth);
  [[nodiscard]] Eigen::Vector3d written_offset(int index) const;
  Result<void> write_motion();
  Result<void> write_frame(int frame);
  Result<void> write_values(int frame, int joint);
  Result<Eigen::Vector3d> written_translation(int frame, int joint) const;
  Result<void> find_angles(int frame, int joint);
  Failure fault(int joint, int frame, std::string_view what, std::string hint = {}) const;

  void indent(int depth) { text_.append(static_cast<std::size_t>(depth), '\t'); }

  const Clip& clip_;
  const Skeleton& skeleton_;
  std::optional<int> decimals_;
  NumberWriter numbers_;
  std::string text_;
  std::vector<Turns> turns_;
};

Failure BvhWriter::fault(int joint, int frame, std::string_view what, std::string hint) const {
  std::string message = "cannot write joint " + in_quotes(skeleton_.joint(joint).name);
  if (frame >= 0) message += " in frame " + std::to_string(frame);
  return run_failure({}, message + " as BVH: " + std::string(what), std::move(hint));
}

Result<void> BvhWriter::check_joint(int index) const {
  const Joint& joint = skeleton_.joint(index);
  const std::string& name = joint.name;
  const auto breaks_line = [](char c) { return is_line_end(c) || is_control(c) || c == '{'; };
  if (name.empty() || is_space(name.front()) || is_space(name.back()) ||
      std::ranges::any_of(name, breaks_line)) {
    return fault(index, -1,
                 "its name is empty, has spaces around it or contains a line break or '{'");
  }
  if (!joint.offset.allFinite() ||
      !std::ranges::all_of(joint.end_sites, [](const auto& site) { return site.allFinite(); })) {
    return fault(index, -1, "an offset is not finite");
  }
  if ((index == 0) != (joint.parent < 0)) return fault(index, -1, "only the first joint is a root");
  return {};
}

Result<void> BvhWriter::check() const {
  if (decimals_ && (*decimals_ < 0 || *decimals_ > kMaxDecimals)) {
    return usage_failure("decimals must be between 0 and " + std::to_string(kMaxDecimals));
  }
  if (skeleton_.joint_count() == 0)
    return run_failure({}, "a skeleton without joints cannot be written as BVH");
  for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
    TRY(check_joint(joint));
  }
  if (skeleton_.channel_count() == 0 && clip_.frame_count() > 0) {
    return run_failure({}, "cannot write frames as BVH: no joint has a channel");
  }
  return {};
}

void BvhWriter::write_offset(const Eigen::Vector3d& offset, int depth) {
  indent(depth);
  text_ += "OFFSET";
  for (const double value : offset) {
    text_ += ' ';
    numbers_.append(text_, value);
  }
  text_ += '\n';
}

void BvhWriter::write_joint(int index, int depth) {
  const Joint& joint = skeleton_.joint(index);
  indent(depth);
  text_ += depth == 0 ? "ROOT " : "JOINT ";
  text_ += joint.name + "\n";
  indent(depth);
  text_ += "{\n";
  write_offset(written_offset(index), depth + 1);
  indent(depth + 1);
  text_ += "CHANNELS " + std::to_string(joint.channels.size());
  for (const Channel channel : joint.channels) {
    text_ += ' ';
    text_ += channel_name(channel);
  }
  text_ += '\n';
  for (const Eigen::Vector3d& site : joint.end_sites) {
    indent(depth + 1);
    text_ += "End Site\n";
    indent(depth + 1);
    text_ += "{\n";
    write_offset(site, depth + 2);
    write_block_end(depth + 1);
  }
}

void BvhWriter::write_block_end(int depth) {
  indent(depth);
  text_ += "}\n";
}

Result<void> BvhWriter::write_hierarchy() {
  text_ += "HIERARCHY\n";
  std::vector<int> open;
  for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
    while (!open.empty() && open.back() != skeleton_.joint(joint).parent) {
      open.pop_back();
      write_block_end(static_cast<int>(open.size()));
    }
    if (open.empty() && joint > 0) return fault(joint, -1, "joints are not in depth-first order");
    write_joint(joint, static_cast<int>(open.size()));
    open.push_back(joint);
  }
  for (; !open.empty(); open.pop_back()) write_block_end(static_cast<int>(open.size()) - 1);
  return {};
}

// Position channels make the OFFSET redundant, but readers treat positions near 0 as relative to
// it. Joints with positions near 0 are therefore written with OFFSET 0.
Eigen::Vector3d BvhWriter::written_offset(int index) const {
  const Joint& joint = skeleton_.joint(index);
  Eigen::Vector3d offset = joint.offset;
  if (!has_positions_near_zero(clip_, index)) return offset;
  for (const Channel channel : joint.channels) {
    if (is_position(channel)) offset[axis_of(channel)] = 0.0;
  }
  return offset;
}

Result<Eigen::Vector3d> BvhWriter::written_translation(int frame, int joint) const {
  const Joint& description = skeleton_.joint(joint);
  const Eigen::Vector3d& translation = clip_.translation(frame, joint);
  if (!translation.allFinite()) return fault(joint, frame, "its translation is not finite");
  Eigen::Vector3d read = description.offset;
  for (const Channel channel : description.channels) {
    if (is_position(channel)) read[axis_of(channel)] = translation[axis_of(channel)];
  }
  const double scale = std::max(1.0, description.offset.cwiseAbs().maxCoeff());
  if ((read - translation).cwiseAbs().maxCoeff() > kOffsetTolerance * scale) {
    return fault(joint, frame, "it leaves its offset along an axis without a position channel",
                 "give the joint all three position channels");
  }
  return translation;
}

Result<void> BvhWriter::find_angles(int frame, int joint) {
  Turns& turns = turns_[joint];
  const Eigen::Quaterniond& rotation = clip_.rotations(frame)[joint];
  const double norm = rotation.norm();
  if (!std::isfinite(norm) || norm == 0.0) return fault(joint, frame, "its rotation is not finite");
  std::swap(turns.before, turns.now);
  const double miss = euler_angles(rotation.normalized(), turns.axes, turns.before, turns.now);
  if (miss > kReachTolerance) {
    return fault(joint, frame, "its rotation channels cannot represent the rotation",
                 "give the joint three rotation channels");
  }
  return {};
}

Result<void> BvhWriter::write_values(int frame, int joint) {
  TRY_ASSIGN(const Eigen::Vector3d translation, written_translation(frame, joint));
  TRY(find_angles(frame, joint));
  std::size_t turn = 0;
  for (const Channel channel : skeleton_.joint(joint).channels) {
    if (!text_.ends_with('\n')) text_ += ' ';
    double value = 1.0;
    if (is_rotation(channel)) {
      value = turns_[joint].now[turn++];
    } else if (is_position(channel)) {
      value = translation[axis_of(channel)];
    }
    numbers_.append(text_, value);
  }
  return {};
}

Result<void> BvhWriter::write_frame(int frame) {
  for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
    TRY(write_values(frame, joint));
  }
  text_ += '\n';
  return {};
}

Result<void> BvhWriter::write_motion() {
  text_ += "MOTION\nFrames: " + std::to_string(clip_.frame_count()) + "\nFrame Time: ";
  NumberWriter(std::nullopt).append(text_, clip_.rate().frame_time());
  text_ += '\n';
  turns_.resize(static_cast<std::size_t>(skeleton_.joint_count()));
  for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
    Turns& turns = turns_[joint];
    for (const Channel channel : skeleton_.joint(joint).channels) {
      if (is_rotation(channel)) turns.axes.push_back(axis_of(channel));
    }
    turns.before.assign(turns.axes.size(), 0.0);
    turns.now = turns.before;
  }
  for (int frame = 0; frame < clip_.frame_count(); ++frame) {
    TRY(write_frame(frame));
  }
  return {};
}

Result<std::string> BvhWriter::write() {
  TRY(check());
  TRY(write_hierarchy());
  TRY(write_motion());
  return std::move(text_);
}

}  // namespace

Result<std::string> format_bvh(const Clip& clip, const BvhWriteOptions& options) {
  return BvhWriter(clip, options).write();
}

Result<void> save_bvh(const std::string& path, const Clip& clip, const BvhWriteOptions& options) {
  Result<std::string> text = format_bvh(clip, options);
  if (!text) {
    Error error = text.error();
    error.location.file = path;
    return failure(std::move(error));
  }
  return write_file(path, *text);
}

}  // namespace retarget
