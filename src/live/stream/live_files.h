#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/plan.h"
#include "retarget/serve.h"

namespace retarget {

inline constexpr const char* kRecordedOutput = "output.jsonl";
inline constexpr const char* kRecordedOptions = "live.json";

/// A file in the folder of a recording.
[[nodiscard]] std::string recorded_file(const std::string& folder, const std::string& name);

/// Checks that no file that a live run writes is also read or written twice, under any name.
/// Errors: kUsage.
[[nodiscard]] Result<void> check_live_files(const ServeOptions& options, const RobotSetup& robot);

}  // namespace retarget
