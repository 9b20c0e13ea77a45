#include "retarget/edit_tables.h"

#include <array>
#include <limits>

#include "retarget/option_name.h"
#include "retarget/try.h"

namespace retarget {

template <>
inline constexpr auto kEnumNames<SeamBlend> = std::to_array<NamedValue<SeamBlend>>(
    {{SeamBlend::kCrossfade, "crossfade"}, {SeamBlend::kInertial, "inertial"}});
template <>
inline constexpr auto kEnumNames<PathKeep> = std::to_array<NamedValue<PathKeep>>(
    {{PathKeep::kTime, "time"}, {PathKeep::kSpeed, "speed"}, {PathKeep::kStride, "stride"}});

namespace {

// Longer than any motion.
constexpr double kLongestCycle = 1e9;

Option number_row(const char* name, auto& member, const char* type, double min, double max,
                  const char* help) {
  return option(name, member, kTimeGroup, type, help, {.min = min, .max = max});
}

Option choice_row(const char* name, auto& member, const char* help) {
  return option(name, member, kTimeGroup, "", help);
}

Option threshold_row(EditSettings& settings) {
  return number_row("threshold", settings.threshold_cm, "CM", 0.0, 1e6,
                    "Maximum pose distance at a seam, cm");
}

Option force_row(EditSettings& settings) {
  return choice_row("force", settings.force, "Join clips even if they do not match");
}

}  // namespace

Result<TimingOptions> EditSettings::timing_options() const {
  TimingOptions options = timing;
  options.linear = interpolation == Interpolation::kLinear;
  options.antialias = !no_antialias;
  if (fps.empty()) return options;
  const auto given = rate_from_text(fps);
  if (!given) return usage_failure(RETARGET_OPTION("fps") ": " + given.error().message);
  if (*given) options.rate = frame_rate_from_fps(**given);
  return options;
}

LoopOptions EditSettings::loop_options() const {
  LoopOptions options = loop;
  options.seam.threshold = 0.01 * threshold_cm;
  return options;
}

Result<ConcatenateOptions> EditSettings::concatenate_options() const {
  ConcatenateOptions options = concat;
  options.threshold = 0.01 * threshold_cm;
  RETARGET_TRY(options.search(search));
  return options;
}

OptionTable resample_table(EditSettings& settings) {
  return {option("fps", settings.fps, kTimeGroup, "N",
                 "Frames per second of the output (default: the source's)"),
          number_row("speed", settings.timing.speed, "N", 0.01, 100.0,
                     "Speed factor: 0.8 takes 1/0.8 of the time"),
          choice_row("interpolation", settings.interpolation,
                     "Interpolation method between source frames"),
          choice_row("no-antialias", settings.no_antialias,
                     "Do not low-pass filter a source whose rate is higher than the output's")};
}

OptionTable ground_table(EditSettings& settings) {
  return {option("floor", settings.floor, kInputGroup, "H",
                 "Floor height in the source, metres (default: height of the standing feet)",
                 {.min = -1e6, .max = 1e6})};
}

OptionTable loop_table(EditSettings& settings) {
  return {number_row("shortest", settings.loop.shortest, "S", 0.0, kLongestCycle,
                     "Minimum length of the cycle, seconds (default: half the clip)"),
          number_row("times", settings.loop.times, "N", std::numeric_limits<int>::min(),
                     std::numeric_limits<int>::max(), "Number of repetitions of the cycle"),
          choice_row("in-place", settings.loop.in_place,
                     "Remove the translation and rotation of the cycle, at a constant rate"),
          threshold_row(settings), force_row(settings)};
}

OptionTable concatenate_table(EditSettings& settings) {
  return {option("search", settings.search, kTimeGroup, "S|all",
                 "Search range for the seam: seconds at the end of the first and the beginning of "
                 "the second clip, or `all` (default: 2, extended until a seam passes the check)"),
          number_row("window", settings.concat.seam.window, "S", 0.0, 10.0,
                     "Length of the compared and blended interval, seconds (default: 1/3)"),
          choice_row("blend", settings.concat.blend,
                     "Blend the common frames, or fade out the difference in the second clip"),
          threshold_row(settings), force_row(settings)};
}

OptionTable path_table(EditSettings& settings) {
  return {
      option("to", settings.path.to, kTimeGroup, "FILE|line|circle|figure8",
             "Path to follow: JSON, or a built-in shape with the length and start of the "
             "motion's own path (default: its own path)"),
      number_row("radius", settings.path.radius, "M", -1e6, 1e6,
                 "Radius of " RETARGET_OPTION("to") " circle, metres; negative values turn right"),
      number_row("scale", settings.path.scale, "N", 0.001, 1000.0,
                 "Scale the path about its beginning"),
      number_row("rotate", settings.path.degrees, "DEG", -1e6, 1e6,
                 "Rotate the path about its beginning, degrees to the left"),
      choice_row("keep", settings.follow_path.keep,
                 "Quantity to keep on a longer or shorter path: the duration (longer strides), "
                 "the speed over the ground (slower motion), or the strides (the motion ends "
                 "after its own distance)"),
      number_row("tolerance", settings.follow_path.fit.tolerance, "M", 0.001, 100.0,
                 "Maximum distance of the fitted path from the track, metres")};
}

}  // namespace retarget
