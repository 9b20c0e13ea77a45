#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/smpl/motion_arrays.h"
#include "motion/clip.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Names of a rate in files of motion capture, data sets and NumPy users, and of its reciprocal.
constexpr std::array kRateNames = {"mocap_framerate", "mocap_frame_rate", "fps", "framerate",
                                   "frame_rate"};
constexpr std::array kTimeNames = {"frame_time", "frametime", "dt"};

constexpr std::string_view kRateHint = "give the frame rate with " OPTION("source-fps");

// A rate in the file. Its number is rounded, so it stands for an interval of rates.
struct StatedRate {
  const char* name;
  FrameRate rate;
  double least, most;  // Frames per second.
};

// Half a unit of the last decimal of a number, which may have been stored in 4 bytes.
double rounding_of(double value) {
  constexpr int kMostDecimals = 9;
  constexpr double kFloatError = 1e-6;
  double unit = 1.0;
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals, unit *= 0.1) {
    const double units = value / unit;
    if (std::abs(units - std::round(units)) <= kFloatError * units) return 0.5 * unit;
  }
  return 0.0;
}

bool is_same(const StatedRate& a, const StatedRate& b) {
  return same_rate(a.rate, b.rate) || (a.least < b.most && b.least < a.most);
}

bool is_more_exact(const StatedRate& a, const StatedRate& b) {
  return a.most * b.least < b.most * a.least;
}

Result<StatedRate> read_rate_array(const ArraySource& file, const char* name) {
  TRY_ASSIGN(const auto array, file.read(name));
  if (!array.is_number() || array.element_count() != 1) {
    return file.array_failure(name,
                              std::string("expected one number, found ") +
                                  (array.is_text() ? "text of" : "numbers of") + " shape " +
                                  shape_text(array.shape),
                              std::string(kRateHint));
  }
  const double fps = array.numbers().front();
  if (is_plausible_rate(fps)) {
    const double error = rounding_of(fps);
    return StatedRate{name, frame_rate_from_fps(fps), fps - error, fps + error};
  }
  return file.array_failure(name,
                            fmt::format("expected a frame rate {}, found {:g}",
                                        fps > 0.0 ? "from 1 to 10000" : "above 0", fps),
                            std::string(kRateHint));
}

// Reads the seconds per frame. Returns nothing for arrays of other shapes, which are something
// else.
Result<std::optional<StatedRate>> read_time_array(const ArraySource& file, const char* name) {
  const auto array = file.read(name);
  if (!array || !array->is_number() || array->element_count() != 1) return std::nullopt;
  const double seconds = array->numbers().front();
  if (!(seconds > 0.0) || !is_plausible_rate(1.0 / seconds)) {
    return file.array_failure(name, fmt::format("expected seconds per frame, found {:g}", seconds),
                              std::string(kRateHint));
  }
  // The time of a whole rate is exact.
  const bool is_whole = same_rate(frame_rate_from_fps(std::round(1.0 / seconds)),
                                  frame_rate_from_frame_time(seconds));
  const double error = is_whole ? 0.0 : rounding_of(seconds);
  return StatedRate{name, frame_rate_from_frame_time(seconds), 1.0 / (seconds + error),
                    1.0 / (seconds - error)};
}

// The rate of an explicit array. Several ones must agree.
Result<std::optional<StatedRate>> explicit_rate(const ArraySource& file) {
  std::optional<StatedRate> found;
  for (const char* name : kRateNames) {
    if (!file.has(name)) continue;
    TRY_ASSIGN(const auto stated, read_rate_array(file, name));
    if (found && !is_same(stated, *found)) {
      return file.array_failure(name,
                                to_text(stated.rate) + " frames per second, but " + found->name +
                                    " says " + to_text(found->rate),
                                std::string(kRateHint));
    }
    if (!found || is_more_exact(stated, *found)) found = stated;
  }
  return found;
}

}  // namespace

Result<MotionRate> read_motion_rate(const ArraySource& file, std::optional<double> source_fps) {
  MotionRate result;
  if (source_fps) {
    result.rate = frame_rate_from_fps(*source_fps);
    return result;
  }
  TRY_ASSIGN(auto found, explicit_rate(file));
  const bool is_explicit = found.has_value();
  std::optional<Error> implausible;
  for (const char* name : kTimeNames) {
    if (!file.has(name)) continue;
    const auto stated = read_time_array(file, name);
    if (!stated && !implausible) implausible = stated.error();
    if (!stated || !*stated) continue;
    if (found && !is_same(**stated, *found)) {
      result.warnings.push_back(
          {0, 0,
           fmt::format("{} is ignored: it gives {} frames per second, {} {}", name,
                       to_text((*stated)->rate), found->name, to_text(found->rate))});
    } else if (!found || (!is_explicit && is_more_exact(**stated, *found))) {
      found = *stated;
    }
  }
  // Next to a plausible rate, an implausible time is something else.
  if (!found && implausible) return failure(*implausible);
  if (found) result.rate = found->rate;
  return result;
}

Failure no_motion_rate(const ArraySource& file) {
  return file.file_failure(fmt::format("no frame rate: found none of {} and {}",
                                       fmt::join(kRateNames, ", "), fmt::join(kTimeNames, ", ")),
                           std::string(kRateHint));
}

std::optional<std::string> missing_frames(const ArraySource& file, int frame_count,
                                          const FrameRate& rate) {
  constexpr const char* kName = "frame_ids";
  if (!file.has(kName)) return std::nullopt;
  const auto array = file.read(kName);
  if (!array || !array->is_number()) return std::nullopt;
  const std::vector<double> ids = array->numbers();
  if (ids.size() != static_cast<std::size_t>(frame_count)) return std::nullopt;
  // Files may contain every second or third frame of the video.
  std::vector<double> steps;
  for (std::size_t i = 1; i < ids.size(); ++i) {
    const double step = ids[i] - ids[i - 1];
    if (step > 0.0 && std::isfinite(step)) steps.push_back(step);
  }
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::ranges::nth_element(steps, middle);
  const double usual = *middle;
  double missing = 0.0;
  std::size_t gaps = 0, first = 0;
  for (std::size_t i = 1; i < ids.size(); ++i) {
    const double step = ids[i] - ids[i - 1];
    if (!(step > 1.5 * usual) || !std::isfinite(step)) continue;
    missing += step / usual - 1.0;
    if (++gaps == 1) first = i;
  }
  if (gaps == 0) return std::nullopt;
  return fmt::format(
      "the array \"{}\" leaves out {:.0f} frames in {}, first after {:.0f} ({:.2f} s of this "
      "motion): the person was lost there, and the motion jumps over the gap",
      kName, missing, count_text(gaps, "place"), ids[first - 1],
      static_cast<double>(first - 1) / rate.fps());
}

}  // namespace retarget
