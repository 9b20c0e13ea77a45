#pragma once

#include "human/candidate.h"

namespace retarget {

/// Whether the left side of a map is the left of the body: where toes point and knees bend is the
/// front, and left x up = front holds of no mirrored body.
/// @return about 1: left is left; about -1: left is right; near 0: the poses do not tell.
[[nodiscard]] double left_is_left(const BodySource& source, const BoneMap& map);

}  // namespace retarget
