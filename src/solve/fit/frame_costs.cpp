#include "solve/fit/frame_costs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/joint_speeds.h"
#include "solve/fit/shorthand.h"

namespace retarget {

int smoothing_context(double frame_time) {
  constexpr double kContext = 0.3;  // Seconds.
  return static_cast<int>(std::ceil(kContext / frame_time));
}

void frame_costs(const FitModel& model, const FitOptions& options, const FitClip& clip,
                 const FitWindow& window, std::span<TermCosts> costs) {
  const int margin = window.fixed_ends ? window.context + 1 : 0;
  const int first = std::max(window.begin - margin, 0);
  const int last = std::min(window.end + margin, clip.frame_count);
  FrameTerms terms(model, options);
  TreeState pose(model.tree);
  JointSpeeds speeds(model, options, clip);
  speeds.update(model, clip, first, last);
  std::vector<std::uint32_t> pairs;
  for (int frame = window.begin; frame < window.end; ++frame) {
    TermCosts& cost = costs[at(frame - window.begin)];
    cost = {};
    pose.update(clip.frame(frame, model.configuration_size));
    if (options.self_collision) {
      terms.find_near_pairs(pose, options.self_collision_margin + kOverlapBand, pairs);
    }
    terms.add_costs(pose, clip.goals(frame, model.tasks.size()), pairs, cost);
    add_limit_margins(model, options, clip.frame(frame, model.configuration_size), nullptr, nullptr,
                      0, cost);
    if (frame + 1 < last) speeds.add_costs(frame, cost);
  }
}

}  // namespace retarget
