#include "retarget/solve.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/plan/human_in_world.h"
#include "app/plan/motion_contacts.h"
#include "app/plan/motion_target.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/options.h"
#include "retarget/run.h"

namespace retarget {
namespace {

// Human and contacts refer to the frames of the motion.
struct SavedMotion {
  const RobotClip& clip;
  std::optional<HumanInWorld> human;
  std::optional<FootContacts> contacts;
};

Result<void> save_with(SavedMotion motion, const std::string& output, const SaveOptions& options) {
  TRY_ASSIGN(const auto items, plan_outputs(output, options));
  WriteMotionOptions write = write_options(output, options);
  write.human = std::move(motion.human);
  write.contacts = std::move(motion.contacts);
  RobotClip moved = motion.clip;
  if (options.normalize_start) normalize_start(moved, write);
  std::vector<MotionTarget> targets;
  for (const OutputItem& item : items) {
    TRY_ASSIGN(MotionTarget target, MotionTarget::create(item));
    TRY_ASSIGN(const auto files, format_motion_files(moved, item.format, write));
    TRY(target.write(files));
    targets.push_back(std::move(target));
  }
  std::optional<OutputFile> contacts;
  if (!options.contacts.empty()) {
    TRY_ASSIGN(contacts, write_contacts(options.contacts, write.contacts, moved.rate()));
  }
  // Commit all files together after they are written.
  for (MotionTarget& target : targets) TRY(target.commit());
  if (contacts) TRY(contacts->commit());
  return {};
}

}  // namespace

Result<void> save(const RobotClip& clip, const std::string& output, const SaveOptions& options) {
  return save_with({clip, std::nullopt, std::nullopt}, output, options);
}

Result<void> save(const Motion& motion, const std::string& output,
                  const std::optional<SaveOptions>& options) {
  return save_with({motion.clip, human_in_world(*motion.source, motion.plan.human.calibration),
                    contacts_of(motion)},
                   output, options.value_or(motion.plan.options.save));
}

}  // namespace retarget
