#pragma once

#include <string>
#include <string_view>

#include "handles.h"
#include "retarget/error.h"

// Clips, robots, plans and motions as bytes, for pickles. Equal values give equal bytes.
//
// A robot is stored by its name or path and the hash of its model. A plan is stored as its clip,
// robot and options, and made again. A solved motion adds its frames and the results of the solver,
// so that nothing is solved again.

namespace retarget::python {

[[nodiscard]] std::string stored(const ClipHandle& clip);
/// Errors (kRun): the model's files could not be read when the robot was loaded.
[[nodiscard]] Result<std::string> stored(const RobotHandle& robot);
[[nodiscard]] Result<std::string> stored(const PlanHandle& plan);
[[nodiscard]] Result<std::string> stored(const MotionHandle& motion);

/// Errors (kUsage): bytes of another version of retarget, or damaged ones.
[[nodiscard]] Result<ClipHandle> clip_of_bytes(std::string_view bytes);
/// Robots of equal bytes are shared while one of them is used.
/// Errors (kConfig): no such robot here, or its model differs from the stored one's.
[[nodiscard]] Result<RobotHandle> robot_of_bytes(std::string_view bytes);
/// Errors (kConfig): as above; a file that the options name has changed.
[[nodiscard]] Result<PlanHandle> plan_of_bytes(std::string_view bytes);
[[nodiscard]] Result<MotionHandle> motion_of_bytes(std::string_view bytes);

}  // namespace retarget::python
