#pragma once

#include <string>

#include "edit/concatenate.h"
#include "edit/seam_feet.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A clip with the human and the feet in it.
struct HumanMotion {
  const Clip& clip;
  HumanClip human;
  ClipFeet feet;

  HumanMotion(const Clip& of, const HumanMapping& mapping);
};

struct JoinedClips {
  Clip clip;
  SeamCheck check;
};

/// Joins b to a at a seam: blends the frames around it, plants the feet and checks what became of
/// it.
/// @param b  where it goes on, of a's skeleton and rate.
/// @param file  for messages.
[[nodiscard]] Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b,
                                             const Seam& seam, const HumanMapping& mapping,
                                             const BodyMover& mover,
                                             const ConcatenateOptions& options,
                                             const std::string& file);

}  // namespace retarget
