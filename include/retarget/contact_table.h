#pragma once

#include <string>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/solved_scene.h"

namespace RETARGET_API retarget {

/// Formats contacts as a table with one line each: part, body of the robot, surface, first and last
/// frame, times in seconds, whether it slides.
/// @param rate  frame rate of the motion.
[[nodiscard]] std::string contacts_text(const ContactLabels& labels, const FrameRate& rate);

/// Formats contacts as JSON: `frames`, `fps`, and `contacts`, a list of objects with `part`,
/// `link`, `surface`, `first`, `last` (frames), `start`, `end` (seconds) and `slides`.
[[nodiscard]] std::string contacts_json(const ContactLabels& labels, const FrameRate& rate);

}  // namespace retarget
