// Edits of time: frame rate, speed, cutting.

#include <string>
#include <utility>

#include "edit/memory_clip.h"
#include "retarget/clip.h"
#include "retarget/clip_range.h"
#include "retarget/edit.h"
#include "retarget/option_name.h"
#include "retarget/options.h"
#include "retarget/resample.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {

Result<Clip> change_timing(Clip clip, const TimingOptions& options) {
  const FrameRate rate = options.rate.value_or(clip.rate());
  if (options.speed) {
    constexpr double kMinFactor = 0.01, kMaxFactor = 100.0;
    if (!(*options.speed >= kMinFactor && *options.speed <= kMaxFactor)) {
      return usage_failure("the speed must be from 0.01 to 100, found " +
                           number_text(*options.speed, 4));
    }
    clip.set_rate(frame_rate_from_fps(clip.rate().fps() * *options.speed));
  }
  return resample(
      without_file_size(std::move(clip)), rate,
      {options.linear ? Interpolation::kLinear : Interpolation::kCubic, options.antialias});
}

Result<Clip> trim(Clip clip, const PartOptions& part) {
  RETARGET_TRY_ASSIGN(const auto range, chosen_range(part, clip.rate(), clip.frame_count()));
  if (range.begin == 0 && range.end == clip.frame_count()) return clip;
  return cut(clip, range.begin, range.end);
}

Edited cut_lead_in(Clip clip, bool can_start) {
  const int count = count_lead_in_frames(clip);
  if (count == 0) return {std::move(clip)};
  const std::string take =
      std::string("; " RETARGET_OPTION("start") " 0 keeps ") + (count == 1 ? "it" : "them");
  return {cut(clip, count, clip.frame_count()),
          {{"lead-in", count_text(count, "frame") +
                           " at the start skipped, because the motion jumps there" +
                           (can_start ? take : std::string())}}};
}

std::string summary(const Clip& clip) {
  return count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) + " fps, " +
         number_text(clip.duration(), 3) + " s";
}

}  // namespace retarget
