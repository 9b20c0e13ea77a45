// Motions of a robot's variants, the information that formats lose, and contacts of the feet.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "formats/robot_motion/motion_writers.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/text.h"
#include "robot/model/variant.h"

namespace retarget {

RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot) {
  RobotClip changed(std::move(robot), clip.rate(), clip.frame_count());
  const Robot& other = changed.robot();
  // Addresses of each joint in both configurations, whose models may differ.
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
  return count_text(lost.size(), "joint") + " with movement would be held, losing up to " +
         number_text(largest, 3) + " rad (" + worst + "): " + list_names(lost, kShown);
}

std::vector<std::string> soma_csv_losses(const RobotClip& motion) {
  if (soma_csv_tells(motion.rate())) return {};
  return {"csv-soma stores no rate: its readers assume 120 fps, this motion has " +
          to_text(motion.rate()) + "; " OPTION("fps") " 120 writes the expected rate"};
}

std::vector<std::string> pbhc_losses(const RobotClip& motion) {
  const auto robot = pbhc_robot(motion.shared_robot());
  if (!robot || *robot == motion.shared_robot()) return {};
  const auto lost = lost_joints(motion, **robot);
  if (!lost) return {};
  const std::string& variant = (*robot)->variant().name;
  return {"pkl-pbhc has the joints of the variant " + variant + ": " + *lost +
          "; " OPTION("dof") " " + variant + " omits them, and pkl-motion-lib stores all joints"};
}

namespace {

// The product of a frame number and the terms of two rates can exceed 64 bits.
__extension__ using WideInt = __int128;

}  // namespace

FootContacts resample_contacts(const FootContacts& contacts, const FrameRate& from,
                               const FrameRate& to, int frames) {
  const WideInt numerator = WideInt{from.frames} * to.seconds;
  const WideInt denominator = WideInt{from.seconds} * to.frames;
  const int last = contacts.frame_count() - 1;
  FootContacts resampled;
  if (last < 0) return resampled;
  resampled.planted.reserve(kContactNames.size() * static_cast<std::size_t>(frames));
  for (WideInt i = 0; i < frames; ++i) {
    // The nearest frame; the earlier one if two are equally near.
    const WideInt nearest = (2 * i * numerator + denominator - 1) / (2 * denominator);
    const auto frame = static_cast<std::ptrdiff_t>(std::min<WideInt>(nearest, last));
    const auto begin =
        contacts.planted.begin() + static_cast<std::ptrdiff_t>(kContactNames.size()) * frame;
    resampled.planted.insert(resampled.planted.end(), begin,
                             begin + static_cast<std::ptrdiff_t>(kContactNames.size()));
  }
  return resampled;
}

std::string format_contacts_csv(const FootContacts& contacts, const FrameRate& rate) {
  std::string text = "frame,time";
  for (const std::string_view name : kContactNames) text += fmt::format(",{}", name);
  text += '\n';
  for (int frame = 0; frame < contacts.frame_count(); ++frame) {
    text += fmt::format("{},{:.6f}", frame, rate.time_of(frame));
    for (std::size_t end = 0; end < kContactNames.size(); ++end) {
      text += contacts.planted[kContactNames.size() * static_cast<std::size_t>(frame) + end] != 0
                  ? ",1"
                  : ",0";
    }
    text += '\n';
  }
  return text;
}

}  // namespace retarget
