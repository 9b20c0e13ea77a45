#include "retarget/solve.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/try.h"
#include "plan/output_files.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "robot/normalize_start.h"

namespace retarget {

Result<void> save(const RobotClip& clip, const std::string& output, const SaveOptions& options) {
  TRY_ASSIGN(const auto items, plan_outputs(output, options));
  const WriteMotionOptions write = write_options(output, options);
  RobotClip moved = clip;
  if (options.normalize_start) normalize_start(moved);
  std::vector<OutputFile> files;
  for (const OutputItem& item : items) {
    TRY_ASSIGN(OutputFile file, OutputFile::create(item.path));
    TRY_ASSIGN(const std::string bytes, format_robot_motion(moved, item.format, write));
    TRY(file.write(bytes));
    files.push_back(std::move(file));
  }
  // together, once all are written
  for (OutputFile& file : files) TRY(file.commit());
  return {};
}

Result<void> save(const Motion& motion, const std::string& output,
                  const std::optional<SaveOptions>& options) {
  return save(motion.clip, output, options.value_or(motion.plan.options.save));
}

}  // namespace retarget
