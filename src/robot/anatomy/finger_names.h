#pragma once

#include <optional>
#include <string>

#include "retarget/human.h"

namespace retarget {

/// Returns the finger that the name of a body or joint contains, as a word or as letters of LEAP's
/// and Shadow's hands; none if it names no finger.
[[nodiscard]] std::optional<Finger> finger_of_name(const std::string& name);

}  // namespace retarget
