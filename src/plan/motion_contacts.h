#pragma once

#include <optional>
#include <string>

#include "base/file.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/solve.h"

namespace retarget {

/// When the ends of the robot's feet are planted. Empty: the motion was not fitted, and nothing
/// keeps them where they are.
[[nodiscard]] std::optional<FootContacts> contacts_of(const Motion& motion);

/// Contacts as CSV, in a file that is not committed yet. Errors (kUsage): they are not known.
[[nodiscard]] Result<OutputFile> write_contacts(const std::string& path,
                                                const std::optional<FootContacts>& contacts,
                                                const FrameRate& rate);

}  // namespace retarget
