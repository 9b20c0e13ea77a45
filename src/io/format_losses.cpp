// What is lost where a motion is written in another format or for another variant of its robot.

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/number_text.h"
#include "base/option_name.h"
#include "base/suggest.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant) {
  constexpr double kEpsilon = 1e-6;
  constexpr std::size_t kShown = 6;
  std::vector<std::string> lost;
  double largest = 0.0;
  std::string worst;
  for (const auto& [name, held] : variant.variant().locked) {
    const auto joint = clip.robot().find_joint(name);
    if (!joint) continue;
    const int address = clip.robot().joints()[*joint].qpos_address;
    double away = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      away = std::max(away, std::abs(clip.qpos(frame)[address] - held));
    }
    if (away > kEpsilon) lost.push_back(name);
    if (away <= largest) continue;
    largest = away;
    worst = name;
  }
  if (lost.empty()) return std::nullopt;
  return count_text(lost.size(), "joint") + " that move are held and lost, by up to " +
         number_text(largest, 3) + " rad (" + worst + "): " + list_names(lost, kShown);
}

std::vector<std::string> format_losses(const RobotClip& motion, MotionFormat format) {
  if (format == MotionFormat::kCsvSoma && !soma_csv_tells(motion.rate())) {
    return {"csv-soma stores no rate: its readers assume 120 fps, this motion has " +
            to_text(motion.rate()) + "; " OPTION("fps") " 120 writes what they expect"};
  }
  if (format != MotionFormat::kPklPbhc) return {};
  const auto robot = pbhc_robot(motion.shared_robot());
  if (!robot || *robot == motion.shared_robot()) return {};
  const auto lost = lost_joints(motion, **robot);
  if (!lost) return {};
  const std::string& variant = (*robot)->variant().name;
  return {"pkl-pbhc has the joints of the variant " + variant + ": " + *lost +
          "; " OPTION("dof") " " + variant + " leaves them out, and pkl-motion-lib has all joints"};
}

}  // namespace retarget
