#include "edit/change_speed.h"

#include <utility>

#include "base/number_text.h"

namespace retarget {

Result<Clip> change_speed(Clip clip, double speed, const ResampleOptions& options) {
  constexpr double kSlowest = 0.01, kFastest = 100.0;
  if (!(speed >= kSlowest && speed <= kFastest)) {
    return usage_failure("a speed must be from 0.01 to 100, found " + number_text(speed, 4));
  }
  const FrameRate rate = clip.rate();
  clip.set_rate(frame_rate_from_fps(rate.fps() * speed));
  return resample(std::move(clip), rate, options);
}

}  // namespace retarget
