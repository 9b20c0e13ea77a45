#pragma once

#include "retarget/robot.h"

namespace retarget {

/// How large a robot is: the length of its legs (hip to knee to ankle) in terms of a G1's, to a
/// hundredth, so that the last digits of a model make no difference. Found from the joints that
/// carry its soles; 1 of a robot without any.
[[nodiscard]] double body_size(const Robot& robot);

}  // namespace retarget
