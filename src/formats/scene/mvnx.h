#pragma once

#include <string>
#include <string_view>

#include "formats/scene/read_scene.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Reads Xsens MVNX: XML with the orientation (w x y z) and position of every body segment per
/// frame, in metres, Z up (MVN User Manual, "MVNX").
///
/// The motion consists of the frames of type `normal`. The rest pose is the frame `tpose`,
/// otherwise `identity`, otherwise `npose`; without them all segments are aligned with the world
/// axes. The document's `joints` define the hierarchy.
///
/// @return kInput errors.
[[nodiscard]] Result<Clip> read_mvnx(std::string_view bytes, const std::string& file_name,
                                     const SceneReadOptions& options);

}  // namespace retarget
