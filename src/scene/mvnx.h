#pragma once

#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "scene/read_scene.h"

namespace retarget {

/// Whether bytes are an MVNX document.
[[nodiscard]] bool looks_like_mvnx(std::string_view bytes);

/// Reads Xsens's MVNX: XML with the orientation (w x y z) and the position of each segment of a body, frame
/// by frame, in metres, Z up (MVN User Manual, "MVNX").
///
/// The motion are the frames of type `normal`. The rest pose is that of the frame `tpose`, else
/// `identity`, else `npose`; without them all segments along the world's axes. Which segment hangs from which,
/// the document's `joints` say.
///
/// @return kInput errors.
[[nodiscard]] Result<Clip> read_mvnx(std::string_view bytes, const std::string& file_name,
                                     const SceneReadOptions& options);

}  // namespace retarget
