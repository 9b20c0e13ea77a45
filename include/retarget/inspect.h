#pragma once

#include <span>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/plan.h"

namespace RETARGET_API retarget {

/// Contents of a motion file: the clip, and the human recognised in it.
struct Inspection {
  std::string file;  ///< File name.
  const Clip& clip;
  std::span<const Warning> warnings;  ///< Warnings from reading the file.
  const BoneMap* map = nullptr;       ///< Null if no human was recognised; `reason` explains why.
  const Calibration* calibration = nullptr;  ///< Likewise.
  const Error* reason = nullptr;
  OptionSpelling spelling = option_as_field;
};

/// Recognises the human in a clip as a run with these options does (find_human): removes noise of
/// joint positions from the clip first, according to HumanOptions::clean.
[[nodiscard]] Result<HumanInClip> find_human_as_run(Clip& clip, const Options& options,
                                                    const std::string& data_folder);

/// The joints, the rate, the extents and the human as JSON that is safe to print on a terminal.
[[nodiscard]] std::string inspection_json(const Inspection& found);

/// Formats the inspection as human-readable text, wrapped to the terminal width except for joint
/// lines. Names from the file are made printable.
[[nodiscard]] std::string inspection_text(const Inspection& found);

/// The world poses of all joints and end sites as CSV: `frame,time`, then `.x .y .z .qx .qy .qz
/// .qw` for each joint. Units and axes are the file's. Numbers are the shortest that parse back to
/// the same doubles.
[[nodiscard]] std::string positions_csv(const Clip& clip);

}  // namespace retarget
