#include "format_losses.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/suggest.h"
#include "outputs.h"

namespace retarget::cli {

std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant) {
  constexpr double kNothing = 1e-6;
  constexpr std::size_t kShown = 6;
  std::vector<std::string> lost;
  double largest = 0.0;
  std::string most;
  for (const auto& [name, held] : variant.variant().locked) {
    const auto joint = variant.find_joint(name);
    if (!joint) continue;
    double away = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      away =
          std::max(away, std::abs(clip.qpos(frame)[variant.joints()[*joint].qpos_address] - held));
    }
    if (away > kNothing) lost.push_back(name);
    if (away <= largest) continue;
    largest = away;
    most = name;
  }
  if (lost.empty()) return std::nullopt;
  return count_text(static_cast<long>(lost.size()), "joint") +
         " that move are held and lost, by up to " + number_text(largest, 3) + " rad (" + most +
         "): " + list_names(lost, kShown);
}

void warn_of_losses(const OutputOptions& options, const RobotClip& motion, Console& console) {
  const auto items = plan_outputs(options);
  if (!items) return;
  for (const OutputItem& item : *items) {
    if (item.format == MotionFormat::kCsvSoma && !soma_csv_tells(motion.rate())) {
      console.warn({{0, 0,
                     "csv-soma says no rate: its readers take 120 fps, this motion has " +
                         to_text(motion.rate()) + "; --fps 120 writes what they expect"}},
                   item.path);
    }
    if (item.format != MotionFormat::kPklPbhc) continue;
    const auto robot = pbhc_robot(motion.shared_robot());
    if (!robot || *robot == motion.shared_robot()) continue;
    const auto lost = lost_joints(motion, **robot);
    if (!lost) continue;
    console.warn({{0, 0,
                   "pkl-pbhc has the joints of the variant " + (*robot)->variant().name + ": " +
                       *lost + "; --dof " + (*robot)->variant().name + " does without them"}},
                 item.path);
  }
}

}  // namespace retarget::cli
