#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "retarget/export.h"

// Clips that show the same motion. Link retarget::batch.
namespace RETARGET_API retarget {

/// Marks a clip as a duplicate of another one.
struct RepeatedClip {
  std::string of;         ///< Name of the other: in a batch, its `relative`.
  bool mirrored = false;  ///< Mirrored left to right.
  double distance = 0.0;  ///< Difference of the motions, degrees.
};

/// Finds duplicates by name. The first clip by name is kept.
/// @param clips  name, and the signature that a manifest has; each name counts once; clips without
///               a signature are never duplicates.
/// @param keep_going  polled regularly; when it returns false, the remaining clips are skipped.
[[nodiscard]] std::map<std::string, RepeatedClip> repeated_clips(
    const std::vector<std::pair<std::string, std::string>>& clips,
    const std::function<bool()>& keep_going = {});

}  // namespace retarget
