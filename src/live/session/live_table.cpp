#include "retarget/live_table.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "retarget/check_options.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {

namespace {

// An option that bounds the robot's motion.
Option bound(const char* name, double& value, const char* unit, const char* help) {
  return option(name, value, kLiveGroup, unit, help, {.min = 1e-3, .max = 1e6});
}

}  // namespace

OptionTable live_table(LiveOptions& options) {
  return {option("mode", options.mode, kLiveGroup, "",
                 "frame: solve every frame immediately; lag: apply the fit of whole clips to the "
                 "latest frames and output them " RETARGET_OPTION("lag") " later",
                 {.basic = true}),
          option("lag", options.lag_s, kLiveGroup, "SECONDS",
                 "Delay of a frame at output, with " RETARGET_OPTION(
                     "mode") " lag: a longer delay is smoother",
                 {.min = 0.0, .max = 60.0, .basic = true}),
          option("fps", options.fps, kLiveGroup, "N",
                 "Robot frames per second, independent of the input rate",
                 {.min = 1.0, .max = 1000.0, .basic = true}),
          option("delay", options.delay_s, kLiveGroup, "SECONDS",
                 "Minimum delay of the human, to absorb network jitter", {.min = 0.0, .max = 10.0}),
          option("hold", options.hold_s, kLiveGroup, "SECONDS",
                 "Hold the last pose this long when the stream stalls, then return to standing",
                 {.min = 0.0, .max = 1e6}),
          option("clock", options.clock, kLiveGroup, "",
                 "Time of a frame: the sender's timestamp if present, or its arrival time"),
          bound("max-root-speed", options.limits.root_speed, "M/S", "Maximum root speed"),
          bound("max-turn-speed", options.limits.turn_speed, "RAD/S", "Maximum root turn rate"),
          bound("max-joint-acceleration", options.limits.joint_acceleration, "RAD/S2",
                "Maximum joint acceleration"),
          bound("max-root-acceleration", options.limits.root_acceleration, "M/S2",
                "Maximum root acceleration"),
          bound("max-turn-acceleration", options.limits.turn_acceleration, "RAD/S2",
                "Maximum angular acceleration of the root"),
          bound("resume-joint-speed", options.limits.resume_joint_speed, "RAD/S",
                "Maximum joint speed right after a gap, a teleport or a new calibration"),
          bound("resume-root-speed", options.limits.resume_root_speed, "M/S",
                "Maximum root speed after such an interruption"),
          bound("resume-turn-speed", options.limits.resume_turn_speed, "RAD/S",
                "Maximum root turn rate after such an interruption"),
          bound("resume-time", options.limits.resume_s, "SECONDS",
                "Time until the full speeds are allowed again")};
}

void make_plain(LiveOptions& options) {
  options.limit_speeds = options.floor = options.hold_feet = false;
}

OptionTable noting_given(OptionTable table, std::vector<std::string>& given) {
  for (Option& row : table) {
    row.set = [set = std::move(row.set), name = row.name, &given](const OptionValue& value) {
      given.push_back(name);
      return set(value);
    };
  }
  return table;
}

namespace {

// Options of the fit that single frames use as well: joint speeds, contacts of feet.
constexpr std::array<std::string_view, 6> kFrameFitOptions = {
    "max_joint_speed",       "max_joint_step", "contact_speed",
    "contact_release_speed", "contact_height", "contact_release_height"};

Result<void> check_fit_of_frames(const Options& run) {
  if (!run.solve.without.empty()) {
    return usage_failure(RETARGET_OPTION("without") " requires " RETARGET_OPTION("mode") " lag",
                         "single frames have no terms of a fit");
  }
  if (run.solve.fit_config.empty()) return {};
  Options usual = run;
  usual.solve.fit_config.clear();
  RETARGET_TRY_ASSIGN(FitOptions fit, choose_fit(run, run.solve.fit));
  RETARGET_TRY_ASSIGN(FitOptions usual_fit, choose_fit(usual, run.solve.fit));
  std::vector<std::string> unused = changed_options(fit_table(fit), fit_table(usual_fit));
  std::erase_if(unused, [](const std::string& name) {
    return std::ranges::find(kFrameFitOptions, name) != kFrameFitOptions.end();
  });
  if (unused.empty()) return {};
  return usage_failure(
      run.solve.fit_config + ": " + list_names(unused) +
          " of " RETARGET_OPTION("fit-config") " requires " RETARGET_OPTION("mode") " lag",
      "single frames use only its joint speed limits and contact thresholds");
}

}  // namespace

Result<void> check_live_use(const LiveOptions& options, const Options& run,
                            std::span<const std::string> given) {
  if (options.mode == LiveMode::kLag) return {};
  if (std::ranges::find(given, "lag") != given.end()) {
    return usage_failure(RETARGET_OPTION("lag") " requires " RETARGET_OPTION("mode") " lag",
                         "add " RETARGET_OPTION("mode") " lag");
  }
  return run.solve.method == Method::kFit ? check_fit_of_frames(run) : Result<void>();
}

Result<void> check_live_options(const LiveOptions& options, Method method) {
  LiveOptions given = options;
  for (const Option& row : live_table(given)) {
    auto sound = check_option(row, row.get());
    if (!sound) return usage_failure(marked_option(row.name) + ": " + sound.error().message);
  }
  if (options.mode != LiveMode::kLag || method == Method::kFit) return {};
  return usage_failure(
      "a lag requires the method fit, which looks ahead; gmr solves single frames",
      "omit " RETARGET_OPTION("method") ", or use " RETARGET_OPTION("mode") " frame");
}

}  // namespace retarget
