#include "formats/bvh/read_bvh.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/bvh/hierarchy_parser.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/source_text.h"
#include "motion/clip.h"
#include "motion/odd_rate.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// One tree of a file and its position among all joints and in the rows.
struct Tree {
  std::shared_ptr<const Skeleton> skeleton;
  std::vector<std::size_t> places;
  int first_column = 0;
  int row_width = 0;  // Values per row, of all trees.
};

Result<std::size_t> find_root(const SourceText& source, const std::vector<std::string>& roots,
                              const std::string& wanted) {
  if (wanted.empty()) return 0;
  const auto found = std::ranges::find(roots, wanted);
  if (found == roots.end()) {
    Error error = source.error_at(
        0, "expected a ROOT " + in_quotes(wanted) + " as " OPTION("root") " requires" +
               did_you_mean(wanted, roots) + ", found " + list_names(roots, 10));
    error.location.line = error.location.column = 0;
    return failure(std::move(error));
  }
  if (std::find(std::next(found), roots.end(), wanted) != roots.end()) {
    Error error = source.error_at(0, "expected one ROOT " + in_quotes(wanted) +
                                         " as " OPTION("root") " requires, found several");
    error.location.line = error.location.column = 0;
    return failure(std::move(error));
  }
  return static_cast<std::size_t>(std::distance(roots.begin(), found));
}

// Extracts the joints of a tree from the hierarchy.
Tree take_tree(Hierarchy& hierarchy, std::size_t tree_index) {
  const int begin = hierarchy.roots[tree_index];
  const int end = tree_index + 1 < hierarchy.roots.size()
                      ? hierarchy.roots[tree_index + 1]
                      : static_cast<int>(hierarchy.joints.size());
  Tree tree;
  std::vector<Joint> joints;
  for (int i = 0; i < static_cast<int>(hierarchy.joints.size()); ++i) {
    Joint& joint = hierarchy.joints[i];
    const int channels = static_cast<int>(joint.channels.size());
    tree.row_width += channels;
    if (i < begin) tree.first_column += channels;
    if (i < begin || i >= end) continue;
    if (joint.parent >= 0) joint.parent -= begin;
    joints.push_back(std::move(joint));
    tree.places.push_back(hierarchy.places[i]);
  }
  tree.skeleton = std::make_shared<const Skeleton>(std::move(joints));
  return tree;
}

class BvhReader {
 public:
  BvhReader(const SourceText& source, const BvhReadOptions& options)
      : source_(source), options_(options), scanner_(source.text()) {}

  Result<BvhFile> read();

 private:
  Result<BvhFile> skeleton_alone(const Tree& tree);
  Result<BvhFile> with_motion(const Tree& tree);
  Result<void> read_rows(const Tree& tree, const MotionHeader& header, Clip& clip);
  [[nodiscard]] std::size_t max_bytes() const;
  [[nodiscard]] std::size_t max_frames(const Skeleton& skeleton) const;
  [[nodiscard]] Failure too_large(const MotionHeader& header, const Skeleton& skeleton,
                                  int frames) const;
  void warn_about_rate(const MotionHeader& header, const Clip& clip);
  void warn_about_positions(const Tree& tree, const PositionReading& reading);
  BvhFile finish(Clip clip);

  const SourceText& source_;
  const BvhReadOptions& options_;
  Scanner scanner_;
  std::vector<Warning> warnings_;
};

Result<BvhFile> BvhReader::read() {
  TRY_ASSIGN(Hierarchy hierarchy, parse_hierarchy(source_, scanner_, options_.root));
  warnings_ = std::move(hierarchy.warnings);
  std::vector<std::string> roots;
  for (const int root : hierarchy.roots) roots.push_back(hierarchy.joints[root].name);
  TRY_ASSIGN(const std::size_t wanted, find_root(source_, roots, options_.root));
  const bool has_motion = hierarchy.has_motion;
  const Tree tree = take_tree(hierarchy, wanted);
  return has_motion ? with_motion(tree) : skeleton_alone(tree);
}

Result<BvhFile> BvhReader::skeleton_alone(const Tree& tree) {
  const std::size_t end = source_.text().size();
  if (!options_.motion_optional) {
    return source_.unexpected_at(end, "MOTION after the skeleton",
                                 "the file has a skeleton but no motion, or was truncated");
  }
  warnings_.push_back(source_.warning_at(end, "no MOTION: only the skeleton is read"));
  const FrameRate rate =
      options_.source_fps ? frame_rate_from_fps(*options_.source_fps) : FrameRate{};
  return finish(Clip(tree.skeleton, rate, 0));
}

Result<BvhFile> BvhReader::with_motion(const Tree& tree) {
  const bool needs_frame_time = !options_.source_fps.has_value();
  TRY_ASSIGN(const MotionHeader header, parse_motion_header(source_, scanner_, needs_frame_time));
  const FrameRate rate = options_.source_fps ? frame_rate_from_fps(*options_.source_fps)
                                             : frame_rate_from_frame_time(*header.frame_time);
  Clip clip(tree.skeleton, rate, 0);
  TRY(read_rows(tree, header, clip));
  if (clip.frame_count() == 0) {
    warnings_.push_back(
        source_.warning_at(header.frames_place, "no frames: only the skeleton is read"));
  }
  if (needs_frame_time) warn_about_rate(header, clip);
  warn_about_positions(tree, read_positions_beside_offsets(clip));
  return finish(std::move(clip));
}

Result<void> BvhReader::read_rows(const Tree& tree, const MotionHeader& header, Clip& clip) {
  if (tree.row_width == 0) {
    if (header.frames == 0) return {};
    return source_.unexpected_at(header.frames_place, "no frames, because no joint has a channel");
  }
  // Bound memory by the text, not by the header: a value takes at least a digit and a space.
  const std::size_t bytes_left = source_.text().size() - scanner_.offset();
  const std::size_t max_rows = (bytes_left + 1) / 2 / static_cast<std::size_t>(tree.row_width);
  if (max_rows > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return source_.failure_at(scanner_.offset(),
                              "expected at most 2^31 - 1 rows, but the file may have more",
                              "split the file");
  }
  // Joints without channels need memory but no text, so limit the frames as well.
  const std::size_t kept_rows = std::min(max_rows, max_frames(*tree.skeleton));
  const auto declared = static_cast<std::uint64_t>(header.frames);
  clip.resize(static_cast<int>(std::min<std::uint64_t>(declared, kept_rows)));

  RowDecoder decoder(*tree.skeleton, tree.first_column);
  const RowSink sink = [&](int index, std::span<const double> row) {
    if (static_cast<std::size_t>(index) >= kept_rows) return;
    if (index >= clip.frame_count()) {
      const std::size_t grown = std::max<std::size_t>(16, 2 * static_cast<std::size_t>(index));
      clip.resize(static_cast<int>(std::min(grown, kept_rows)));
    }
    decoder.decode(row, clip, index);
  };
  const MotionRowsOptions rows_options = {static_cast<std::size_t>(tree.row_width), header.frames,
                                          header.frames_place, options_.lenient};
  TRY_ASSIGN(MotionRows rows, parse_motion_rows(source_, scanner_, rows_options, sink));
  if (static_cast<std::size_t>(rows.count) > kept_rows) {
    return too_large(header, *tree.skeleton, rows.count);
  }
  clip.resize(rows.count);
  std::ranges::move(rows.warnings, std::back_inserter(warnings_));
  return {};
}

std::size_t BvhReader::max_bytes() const {
  const std::size_t of_text = BvhReadOptions::kMaxBytesOfText * source_.text().size();
  return std::min(options_.max_clip_bytes, std::max(BvhReadOptions::kFreeClipBytes, of_text));
}

std::size_t BvhReader::max_frames(const Skeleton& skeleton) const {
  return max_bytes() / frame_bytes(skeleton);
}

Failure BvhReader::too_large(const MotionHeader& header, const Skeleton& skeleton,
                             int frames) const {
  const double needed = static_cast<double>(frame_bytes(skeleton)) * frames;
  const bool by_user = max_bytes() == options_.max_clip_bytes;
  return source_.failure_at(
      header.frames_place,
      std::to_string(frames) + " frames of " + std::to_string(skeleton.joint_count()) +
          " joints need " + number_text(needed / 1e6, 1) + " MB of memory, at most " +
          number_text(static_cast<double>(max_bytes()) / 1e6, 1) + " MB are allowed" +
          (by_user ? "" : " for a file of this size"),
      by_user ? OPTION("memory") " allows more; or split the file"
              : "remove the joints without channels, which never move relative to their parents");
}

void BvhReader::warn_about_rate(const MotionHeader& header, const Clip& clip) {
  if (const auto odd = odd_rate_text(clip.rate(), clip.frame_count())) {
    warnings_.push_back(source_.warning_at(header.frame_time_place, "Frame Time gives " + *odd));
  }
}

void BvhReader::warn_about_positions(const Tree& tree, const PositionReading& reading) {
  const auto warn = [&](const std::vector<int>& joints, const std::string& what) {
    if (joints.empty()) return;
    std::vector<std::string> names;
    names.reserve(joints.size());
    for (const int joint : joints) names.push_back(in_quotes(tree.skeleton->joint(joint).name));
    warnings_.push_back(
        source_.warning_at(tree.places[joints.front()], what + list_names(names, 5)));
  };
  warn(reading.unmoved, "position channels that are 0 in every frame: the OFFSET is used for ");
  warn(reading.changes,
       "position channels that are near 0 compared with the OFFSET: they are added to it for ");
}

BvhFile BvhReader::finish(Clip clip) {
  if (scanner_.comment_count() > 0) {
    warnings_.push_back(source_.warning_at(scanner_.first_comment(), "comment lines skipped"));
  }
  std::ranges::stable_sort(warnings_, [](const Warning& a, const Warning& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  return {std::move(clip), std::move(warnings_)};
}

}  // namespace

Result<BvhFile> read_bvh(std::string_view bytes, const std::string& file_name,
                         const BvhReadOptions& options) {
  if (options.source_fps && !(std::isfinite(*options.source_fps) && *options.source_fps > 0.0)) {
    return usage_failure("the source frame rate must be a finite number above 0");
  }
  const SourceText source(without_byte_order_mark(bytes), file_name);
  try {
    return BvhReader(source, options).read();
  } catch (const std::bad_alloc&) {
    return run_failure(file_name, "not enough memory for the motion in this file");
  }
}

Result<BvhFile> load_bvh(const std::string& path, const BvhReadOptions& options) {
  TRY_ASSIGN(const FileContent bytes, read_file(path));
  return read_bvh(bytes.view(), path == "-" ? "<stdin>" : path, options);
}

namespace {

// Fraction of the OFFSET below which positions count as near 0.
constexpr double kNearZero = 0.05;

// Position channels of a joint and the matching components of its OFFSET.
class JointPositions {
 public:
  JointPositions(const Clip& clip, int joint)
      : clip_(&clip), joint_(joint), slot_(clip.skeleton().translation_slot(joint)) {
    if (slot_ < 0) return;
    for (const Channel channel : clip.skeleton().joint(joint).channels) {
      if (is_position(channel)) has_channel_[axis_of(channel)] = 1.0;
    }
    offset_ = has_channel_.cwiseProduct(clip.skeleton().joint(joint).offset);
    length_ = offset_.norm();
  }

  [[nodiscard]] int joint() const { return joint_; }
  [[nodiscard]] int slot() const { return slot_; }
  [[nodiscard]] const Eigen::Vector3d& offset() const { return offset_; }
  [[nodiscard]] bool has_offset() const { return length_ > 0.0; }

  // Whether all positions are within `distance` of 0. Most files fail in their first frame.
  [[nodiscard]] bool stay_below(double distance) const {
    for (int frame = 0; frame < clip_->frame_count(); ++frame) {
      if (position(frame).norm() > distance) return false;
    }
    return true;
  }
  [[nodiscard]] bool stay_near_zero() const { return stay_below(kNearZero * length_); }

  // Compares the mean distances.
  [[nodiscard]] bool are_nearer_to_zero() const {
    double difference = 0.0;
    for (int frame = 0; frame < clip_->frame_count(); ++frame) {
      difference += position(frame).norm() - (position(frame) - offset_).norm();
    }
    return difference < 0.0;
  }

 private:
  [[nodiscard]] Eigen::Vector3d position(int frame) const {
    return has_channel_.cwiseProduct(clip_->translations(frame)[slot_]);
  }

  const Clip* clip_;
  int joint_;
  int slot_;
  Eigen::Vector3d has_channel_ = Eigen::Vector3d::Zero();  // 1 for components with a channel.
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  double length_ = 0.0;
};

}  // namespace

PositionReading read_positions_beside_offsets(Clip& clip) {
  PositionReading reading;
  if (clip.frame_count() == 0) return reading;
  std::vector<JointPositions> near_zero, others;
  for (int joint = 1; joint < clip.skeleton().joint_count(); ++joint) {
    const JointPositions positions(clip, joint);
    if (!positions.has_offset()) continue;
    (positions.stay_near_zero() ? near_zero : others).push_back(positions);
  }
  const bool most_are_changes = near_zero.size() > others.size();
  std::vector<JointPositions> added = near_zero;
  if (most_are_changes) {
    std::ranges::copy_if(others, std::back_inserter(added), &JointPositions::are_nearer_to_zero);
  }
  std::ranges::sort(added, {}, &JointPositions::joint);
  for (const JointPositions& positions : added) {
    (positions.stay_below(0.0) ? reading.unmoved : reading.changes).push_back(positions.joint());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      clip.translations(frame)[positions.slot()] += positions.offset();
    }
  }
  return reading;
}

bool has_positions_near_zero(const Clip& clip, int joint) {
  const JointPositions positions(clip, joint);
  return joint > 0 && clip.frame_count() > 0 && positions.has_offset() &&
         positions.stay_near_zero();
}

}  // namespace retarget
