#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"

namespace retarget {

/// What makes the files of a motion, by family; the formats' table (motion_format.h) names them.
/// Each takes the format, as families share most of what they do.

using MotionFiles = Result<std::vector<FormattedFile>>;

[[nodiscard]] MotionFiles write_csv(const RobotClip& clip, MotionFormat format,
                                    const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_tracking_npz(const RobotClip& clip, MotionFormat format,
                                             const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_gmr_pickle(const RobotClip& clip, MotionFormat format,
                                           const WriteMotionOptions& options);
/// kPklPbhc and kPklMotionLib.
[[nodiscard]] MotionFiles write_motion_lib_pickle(const RobotClip& clip, MotionFormat format,
                                                  const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_mimickit_pickle(const RobotClip& clip, MotionFormat format,
                                                const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_protomotions(const RobotClip& clip, MotionFormat format,
                                             const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_sonic_folder(const RobotClip& clip, MotionFormat format,
                                             const WriteMotionOptions& options);
[[nodiscard]] MotionFiles write_glb(const RobotClip& clip, MotionFormat format,
                                    const WriteMotionOptions& options);

/// A motion of one file without a name.
[[nodiscard]] inline MotionFiles one_file(Result<std::string> bytes) {
  if (!bytes) return failure(std::move(bytes).error());
  std::vector<FormattedFile> files;
  files.push_back({{}, std::move(*bytes)});
  return files;
}

/// make_tracking_motion with the motion's contacts, where they are known.
[[nodiscard]] Result<TrackingMotion> tracking_with_contacts(const RobotClip& clip,
                                                            MotionFormat format,
                                                            const WriteMotionOptions& options,
                                                            const TrackingOptions& tracking);

}  // namespace retarget
