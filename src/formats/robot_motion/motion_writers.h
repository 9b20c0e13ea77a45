#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"

namespace retarget {

/// Writers of motion files, one per family of formats; the table of formats assigns them to formats
/// (formats/registry/format.h). Each takes the format, because a family shares most code.

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

/// Names of the files that a folder of SONIC may contain.
[[nodiscard]] std::vector<std::string> sonic_file_names();

/// Losses of a motion in a format, one line each; see format_losses.
[[nodiscard]] std::vector<std::string> soma_csv_losses(const RobotClip& motion,
                                                       const FrameRate& rate);
[[nodiscard]] std::vector<std::string> sonic_losses(const RobotClip& motion, const FrameRate& rate);
[[nodiscard]] std::vector<std::string> pbhc_losses(const RobotClip& motion, const FrameRate& rate);

/// A single file without a name.
[[nodiscard]] inline MotionFiles one_file(Result<std::string> bytes) {
  if (!bytes) return failure(std::move(bytes).error());
  std::vector<FormattedFile> files;
  files.push_back({{}, std::move(*bytes)});
  return files;
}

/// Number of samples of make_tracking_motion.
[[nodiscard]] int tracking_frame_count(const RobotClip& clip, MotionFormat format,
                                       const TrackingOptions& options);

/// make_tracking_motion with the motion's contacts and scene, if they are known.
[[nodiscard]] Result<TrackingMotion> tracking_with_contacts(const RobotClip& clip,
                                                            MotionFormat format,
                                                            const WriteMotionOptions& options,
                                                            const TrackingOptions& tracking);

}  // namespace retarget
