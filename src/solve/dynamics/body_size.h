#pragma once

#include "retarget/robot.h"

namespace retarget {

/// Size of a robot: its leg length (hip to knee to ankle) relative to a G1's. Rounded to a
/// hundredth, so that the last digits of a model have no influence. Derived from the joints that
/// carry its soles; 1 if it has none.
[[nodiscard]] double body_size(const Robot& robot);

}  // namespace retarget
