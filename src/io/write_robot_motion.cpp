#include "retarget/motion_io.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "io/gltf_motion.h"
#include "io/motion_format.h"
#include "io/motion_writers.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "robot/variant.h"

namespace retarget {

RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot) {
  RobotClip changed(std::move(robot), clip.rate(), clip.frame_count());
  const Robot& other = changed.robot();
  // places of a joint in a configuration of this robot and of the other, whose models may differ
  std::vector<std::pair<int, int>> addresses;
  for (const int index : other.output_joints()) {
    const RobotJoint& joint = other.joints()[index];
    const auto own = clip.robot().find_joint(joint.name);
    if (!own) continue;
    addresses.emplace_back(clip.robot().joints()[*own].qpos_address, joint.qpos_address);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto from = clip.qpos(frame);
    const auto to = changed.qpos(frame);
    for (std::size_t i = 0; i < 7; ++i) to[i] = from[i];
    for (const auto& [source, target] : addresses) to[target] = from[source];
  }
  return changed;
}

Result<std::shared_ptr<const Robot>> pbhc_robot(const std::shared_ptr<const Robot>& robot) {
  if (!robot->variant().name.empty()) return robot;
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.name.ends_with("pbhc")) return robot_variant(robot, variant.name);
  }
  return robot;
}

MotionFiles write_csv(const RobotClip& clip, MotionFormat format,
                      const WriteMotionOptions& options) {
  const bool soma = format == MotionFormat::kCsvSoma;
  return one_file(format_robot_csv(
      clip, soma ? soma_csv_options(clip.rate(), options.csv.precision) : options.csv));
}

MotionFiles write_glb(const RobotClip& clip, MotionFormat /*format*/,
                      const WriteMotionOptions& options) {
  return one_file(format_robot_glb(clip, options.human ? &*options.human : nullptr, options.name));
}

Result<std::vector<FormattedFile>> format_motion_files(const RobotClip& clip, MotionFormat format,
                                                       const WriteMotionOptions& options) {
  return format_facts(format).write(clip, format, options);
}

Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                        const WriteMotionOptions& options) {
  if (format_is_folder(format)) {
    return usage_failure(std::string(format_name(format)) + " is a folder and not one file");
  }
  TRY_ASSIGN(auto files, format_motion_files(clip, format, options));
  return std::move(files.front().bytes);
}

}  // namespace retarget
