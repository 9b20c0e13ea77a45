#include "live/session/live_body.h"

#include <cmath>
#include <utility>

namespace retarget {

LiveBody::LiveBody(std::unique_ptr<LiveTargets> made, const LiveOptions& options, double frame_time)
    : targets(std::move(made)),
      feet(live_feet(targets->model(), frame_time)),
      floor(targets->options(), frame_time),
      holder(targets->model(), targets->options(), frame_time, feet.size()) {
  if (options.mode != LiveMode::kLag) return;
  const auto frames = static_cast<int>(std::lround(options.lag_s / frame_time));
  lag.emplace(*targets, frame_time, frames);
}

void LiveBody::restart(bool settles) {
  if (settles) targets->settle_next();
  for (LiveFoot& foot : feet) foot.restart();
  holder.restart();
  if (lag) lag->restart();
}

}  // namespace retarget
