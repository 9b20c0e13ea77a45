#include "smpl/motion_rate.h"

#include <string>

#include <fmt/format.h>

#include "base/option_name.h"
#include "base/try.h"
#include "motion/clip_size.h"

namespace retarget {
namespace {

constexpr std::string_view kRateHint = "give the frame rate with " OPTION("source-fps");

Result<double> read_rate_array(const ArraySource& file, const char* name) {
  TRY_ASSIGN(const auto array, file.read(name));
  if (!array.is_number() || array.element_count() != 1) {
    return file.array_failure(name,
                              std::string("expected one number, found ") +
                                  (array.is_text() ? "text of" : "numbers of") + " shape " +
                                  shape_text(array.shape),
                              std::string(kRateHint));
  }
  const double fps = array.numbers().front();
  if (is_plausible_rate(fps)) return fps;
  return file.array_failure(name,
                            fmt::format("expected a frame rate {}, found {:g}",
                                        fps > 0.0 ? "from 1 to 10000" : "above 0", fps),
                            std::string(kRateHint));
}

}  // namespace

Result<std::optional<FrameRate>> read_motion_rate(const ArraySource& file,
                                                  std::optional<double> source_fps) {
  if (source_fps) return frame_rate_from_fps(*source_fps);
  std::optional<FrameRate> found;
  const char* first = nullptr;
  for (const char* name : {"mocap_framerate", "mocap_frame_rate", "fps"}) {
    if (!file.has(name)) continue;
    TRY_ASSIGN(const auto fps, read_rate_array(file, name));
    const FrameRate rate = frame_rate_from_fps(fps);
    if (found && !same_rate(rate, *found)) {
      return file.array_failure(
          name, to_text(rate) + " frames per second, but " + first + " says " + to_text(*found),
          std::string(kRateHint));
    }
    if (found) continue;
    found = rate;
    first = name;
  }
  return found;
}

Failure no_motion_rate(const ArraySource& file) {
  return file.file_failure("no frame rate: found none of mocap_framerate, mocap_frame_rate and fps",
                           std::string(kRateHint));
}

}  // namespace retarget
