#pragma once

#include <string>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A canonical human as a clip in the shape of LAFAN1: its 22 joints in its order, names and axes,
/// centimetres, y up, rotations z y x. What reads LAFAN1 reads any source this way.
///
/// The body is brought to the size that readers of LAFAN1 take for granted (HumanClipInfo::size
/// becomes 1.75 m); offsets are the means of the bones' places over the clip, so lengths are the
/// source's own in proportion. Joints that the source lacks stand at their parents and turn with
/// them. The path over the floor is scaled along.
///
/// @param file  for messages.
/// @return a kInput error when the hips, a leg or an arm is missing.
[[nodiscard]] Result<Clip> lafan1_clip(const HumanClip& human, const std::string& file);

}  // namespace retarget
