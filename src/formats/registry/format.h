#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/containers/file_kind.h"
#include "formats/robot_motion/raw_motion.h"
#include "formats/smpl/joint_motion.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file_endings.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {

struct HumanReadOptions {
  const SourceOptions& source;
  bool skeleton_only = false;  ///< Accept a file with a skeleton and no motion.
  std::size_t max_bytes = 0;   ///< Memory limit of the clip.
};

/// A human motion as its reader returns it: a clip, or joint positions without rotations.
using HumanFile = std::variant<Clip, JointMotion>;

/// Files with the same reader, which distinguishes the formats of its family by their content. A
/// family of human motions has read_human. A family without any reader is only written.
struct FormatFamily {
  unsigned kinds;  ///< Content types of its files, one bit per FileKind; 0: a folder.
  /// Extensions that a batch searches for in folders, and further ones, separated by blanks.
  /// Outputs use the first one.
  std::string_view endings, other_endings;
  Result<HumanFile> (*read_human)(std::string_view bytes, const std::string& file,
                                  const HumanReadOptions& options);
  Result<RawMotion> (*read_robot)(std::string_view bytes, const std::shared_ptr<const Robot>& robot,
                                  const std::string& file, const ReadMotionOptions& options);

  [[nodiscard]] bool reads(FileKind kind) const {
    return (kinds >> static_cast<unsigned>(kind) & 1U) != 0;
  }
};

/// A motion file format: one row of the only table of formats.
struct Format {
  std::string_view name;
  const FormatFamily& family;
  std::string_view file, programs, page;  ///< Texts of the table in docs/formats.md.

  // Robot motions only.
  std::string_view array = {};  ///< An array that only robot motions have.
  MotionFormat motion_format = MotionFormat::kCsv;
  std::string_view long_ending = {};  ///< Extension that distinguishes formats of one motion.
  bool own_rate = false;  ///< Files have the tracker's rate (TrackingOptions), not the motion's.
  Result<std::vector<FormattedFile>> (*write)(const RobotClip& clip, MotionFormat format,
                                              const WriteMotionOptions& options) = nullptr;
  std::vector<std::string> (*losses)(const RobotClip& motion,
                                     const FrameRate& rate) = nullptr;  ///< Null: none.
  /// Names of the options that only some formats use, separated by blanks.
  std::string_view options = {};
  bool is_float32 = false;  ///< Root and joints are stored as float32.

  [[nodiscard]] bool is_robots() const { return write != nullptr; }
};

/// All formats: those of humans, then those of robots in the order of docs/formats.md.
[[nodiscard]] std::span<const Format> all_formats();

[[nodiscard]] const Format& robot_format(MotionFormat format);

/// Names of the formats that use an option; none if all formats do.
[[nodiscard]] std::vector<std::string> formats_with_option(std::string_view option);

/// Reads a human motion in the format of its content. Errors (kUsage): options that do not apply to
/// this format. If the content may be a robot's motion, the hint explains how to read it.
[[nodiscard]] Result<HumanFile> read_human_file(std::string_view bytes, const std::string& file,
                                                const HumanReadOptions& options);

/// Rejects a large binary file, such as a video, by its first bytes before it is read. Other files
/// pass, also files that cannot be opened: their readers report them.
[[nodiscard]] Result<void> check_start_of_large_file(const std::string& path);

/// The usual extension of outputs for this extension, such as `.pkl` for `.joblib`; empty if no
/// output has it.
[[nodiscard]] std::string_view output_ending(std::string_view ending);

/// Readers of human formats, for the table.
[[nodiscard]] Result<HumanFile> read_bvh_file(std::string_view bytes, const std::string& file,
                                              const HumanReadOptions& options);
[[nodiscard]] Result<HumanFile> read_array_file(std::string_view bytes, const std::string& file,
                                                const HumanReadOptions& options);
[[nodiscard]] Result<HumanFile> read_scene_file(std::string_view bytes, const std::string& file,
                                                const HumanReadOptions& options);

}  // namespace retarget
