#pragma once

#include <span>
#include <string>

#include "human/bone_map.h"
#include "human/calibrate.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// What a motion file holds: the clip as it was read, and the human in it.
struct Inspection {
  std::string file;  ///< Its name.
  const Clip& clip;
  std::span<const Warning> warnings;         ///< Of reading it.
  const BoneMap* map = nullptr;              ///< Null: no human was understood, `reason` says why.
  const Calibration* calibration = nullptr;  ///< Likewise.
  const Error* reason = nullptr;
  OptionSpelling spelling = option_as_field;
};

/// Joints, rate, extents and the human, as JSON; may be shown at a terminal.
[[nodiscard]] std::string inspection_json(const Inspection& found);

/// The same for people, in lines of a terminal's width but for the joints'. Names are as the file has
/// them (printable).
[[nodiscard]] std::string inspection_text(const Inspection& found);

/// World poses of all joints and end sites as CSV: `frame,time`, then `.x .y .z .qx .qy .qz .qw` of
/// each; file units and axes, the shortest numbers that read back to the same doubles.
[[nodiscard]] std::string positions_csv(const Clip& clip);

}  // namespace retarget
