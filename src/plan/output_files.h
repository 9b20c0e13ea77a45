#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {

/// A file that a motion is written to.
struct OutputItem {
  MotionFormat format = MotionFormat::kCsv;
  std::string path;  ///< `-`: standard output.
};

/// Which files an output and its formats name. One format: the output is the file's name. Several:
/// each name is that of the output, without .csv, .npz, .pkl or .glb at its end, and the format's long
/// ending: walk.csv, walk.mjlab.npz.
///
/// Usage errors: a format twice, an ending that says another kind of file than the format, .npz and
/// .pkl without a format, several formats to standard output.
[[nodiscard]] Result<std::vector<OutputItem>> plan_outputs(const std::string& output,
                                                           const SaveOptions& options);

/// Rate of a format's file: trackers' formats have their own.
/// @param motion  what the others have.
[[nodiscard]] FrameRate rate_of_format(MotionFormat format, const SaveOptions& options,
                                       const FrameRate& motion);

/// The rates that the formats ask for, each once; the motion's own first where any has it. A fit
/// solves a motion at each of them; the published method solves it at its own, and what needs
/// another is interpolated.
[[nodiscard]] std::vector<FrameRate> solved_rates(const SaveOptions& options, Method method,
                                                  const FrameRate& motion);

/// How the options want a motion to be written.
/// @param output  whose name the motion takes where it needs one.
[[nodiscard]] WriteMotionOptions write_options(const std::string& output,
                                               const SaveOptions& options);

}  // namespace retarget
