#pragma once

#include <optional>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/solve.h"

namespace retarget {

/// Returns when the ends of the robot's feet are planted. Empty: the motion was not fitted, so
/// nothing holds the feet.
[[nodiscard]] std::optional<FootContacts> contacts_of(const Motion& motion);

/// Writes contacts as CSV to a file that is not committed yet. Error (kUsage): contacts are
/// unknown.
[[nodiscard]] Result<OutputFile> write_contacts(const std::string& path,
                                                const std::optional<FootContacts>& contacts,
                                                const FrameRate& rate);

}  // namespace retarget
