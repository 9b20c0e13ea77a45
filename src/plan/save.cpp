#include "retarget/solve.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/try.h"
#include "plan/human_in_world.h"
#include "plan/output_files.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "robot/normalize_start.h"

namespace retarget {
namespace {

Result<void> save_with(const RobotClip& clip, std::optional<HumanInWorld> human,
                       const std::string& output, const SaveOptions& options) {
  TRY_ASSIGN(const auto items, plan_outputs(output, options));
  WriteMotionOptions write = write_options(output, options);
  write.human = std::move(human);
  RobotClip moved = clip;
  if (options.normalize_start) normalize_start(moved, write);
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

}  // namespace

Result<void> save(const RobotClip& clip, const std::string& output, const SaveOptions& options) {
  return save_with(clip, std::nullopt, output, options);
}

Result<void> save(const Motion& motion, const std::string& output,
                  const std::optional<SaveOptions>& options) {
  return save_with(motion.clip, human_in_world(*motion.source, motion.plan.human.calibration),
                   output, options.value_or(motion.plan.options.save));
}

}  // namespace retarget
