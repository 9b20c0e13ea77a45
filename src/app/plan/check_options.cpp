#include "retarget/check_options.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/bone_map.h"
#include "retarget/clip_range.h"
#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/write_scene.h"

namespace retarget {
namespace {

constexpr const char* kOneOfThem = "give only one of them";

}  // namespace

Result<void> check_human_options(const HumanOptions& options) {
  TRY(unit_from_text(options.unit));
  const bool has_frame = options.tpose_frame >= 0, has_rest = options.rest != RestPose::kAuto;
  if (has_frame && has_rest) {
    return usage_failure(OPTION("rest") " and " OPTION("tpose-frame") " both choose a rest pose",
                         kOneOfThem);
  }
  if (!options.tpose_file.empty() && (has_frame || has_rest)) {
    return usage_failure(OPTION("tpose-file") " cannot be combined with another rest pose",
                         kOneOfThem);
  }
  return {};
}

Result<void> check_robot_choice(const RobotChoice& robot) {
  if (robot.name.empty() && robot.model.empty()) {
    return usage_failure("no robot is given",
                         "add " OPTION("robot") " NAME or " OPTION("robot-xml") " FILE");
  }
  if (!robot.name.empty() && !robot.model.empty()) {
    return usage_failure(OPTION("robot") " and " OPTION("robot-xml") " both name a robot",
                         kOneOfThem);
  }
  if (!robot.profile.empty() && robot.model.empty()) {
    return usage_failure(OPTION("robot-profile") " requires " OPTION("robot-xml"),
                         "add " OPTION("robot-xml") " FILE");
  }
  return {};
}

Result<void> check_config_choice(const RobotChoice& robot, const SolveOptions& options) {
  if (robot.model.empty() || !options.ik_config.empty()) return {};
  return usage_failure(
      OPTION("robot-xml") " has no retargeting configuration",
      "add " OPTION("ik-config") " FILE, or create a robot from the model: retarget robots add "
      "NAME " OPTION("model") " FILE");
}

namespace {

// Rejects options that change a scene if there is no scene.
Result<void> check_without_scene(const SolveOptions& solve) {
  const bool changes = !solve.terrain_scale.empty() || !solve.object_shift.empty() ||
                       solve.object_scale != 1.0 || solve.scene_axes != SceneAxes::kHuman ||
                       solve.object_motion != ObjectMotion::kGiven;
  if (changes) {
    return usage_failure(
        OPTION("scene-axes") ", " OPTION("terrain-scale") ", " OPTION("object-shift") ", " OPTION(
            "object-scale") " and " OPTION("object-motion") " require " OPTION("scene"),
        "add " OPTION("scene") " FILE");
  }
  if (solve.object_tracks.empty()) return {};
  return usage_failure(OPTION("object-track") " requires " OPTION("scene"),
                       "add " OPTION("scene") " FILE with the shape of the object");
}

Result<void> check_scene_options(const SolveOptions& solve, const SaveOptions& save) {
  if (!save.scene_out.empty()) TRY(check_scene_ending(save.scene_out));
  if (solve.scene.empty()) TRY(check_without_scene(solve));
  const bool has_scene = !solve.scene.empty(), has_terrain = !solve.terrain.empty();
  if (!has_scene && !has_terrain) {
    if (save.scene_out.empty()) return {};
    return usage_failure(OPTION("scene-out") " requires " OPTION("scene"),
                         "add " OPTION("scene") " FILE or " OPTION("terrain"));
  }
  const std::string given = has_scene ? OPTION("scene") : OPTION("terrain");
  if (has_scene && has_terrain) {
    return usage_failure(OPTION("terrain") " cannot be combined with " OPTION("scene"),
                         "it needs a walk on a flat floor");
  }
  if (solve.method != Method::kFit) {
    return usage_failure(given + " requires " OPTION("method") " fit",
                         "the published method does not support scenes");
  }
  if (has_scene && !solve.travel.empty() && solve.travel != "1") {
    return usage_failure(OPTION("scene") " cannot be combined with " OPTION("travel"),
                         "omit " OPTION("travel") ": the scene does not move with a scaled path");
  }
  return {};
}

// Rejects options of the fit, which programs set without an options file, for other methods.
Result<void> check_fit_unused(FitOptions fit) {
  FitOptions default_options;
  fit.threads = default_options.threads;  // Front ends set it for every method.
  const auto given = changed_options(fit_table(fit), fit_table(default_options));
  if (given.empty()) return {};
  return usage_failure("the fit option \"" + given.front() + "\" requires " OPTION("method") " fit",
                       "omit " OPTION("method"));
}

}  // namespace

Result<void> check_solving_options(const Options& options) {
  const SolveOptions& solve = options.solve;
  TRY(check_scene_options(solve, options.save));
  if (solve.method != Method::kFit) TRY(check_fit_unused(solve.fit));
  if (solve.method != Method::kFit && (!solve.fit_config.empty() || !solve.with.empty() ||
                                       !solve.without.empty() || solve.fit_window_s > 0.0)) {
    return usage_failure(
        OPTION("fit-config") ", " OPTION("with") ", " OPTION("without") " and " OPTION(
            "window") " require " OPTION("method") " fit",
        "omit " OPTION("method"));
  }
  if (solve.method != Method::kFit && (solve.purpose || !solve.travel.empty())) {
    return usage_failure(OPTION("for") " and " OPTION("travel") " require " OPTION("method") " fit",
                         "omit " OPTION("method"));
  }
  if (!solve.time_scale.empty()) {
    if (const auto scale = time_scale_from_text(solve.time_scale); !scale) {
      return usage_failure(OPTION("time-scale") ": " + scale.error().message);
    }
  }
  if (!solve.travel.empty()) {
    if (const auto travel = travel_from_text(solve.travel); !travel) {
      return usage_failure(OPTION("travel") ": " + travel.error().message);
    }
  }
  if (solve.method != Method::kFit && !options.save.contacts.empty()) {
    return usage_failure(OPTION("contacts") " requires " OPTION(
                             "method") " fit: the published method does not use contacts",
                         "omit " OPTION("method"));
  }
  if (solve.method != Method::kFit && !solve.contact_edits.empty()) {
    return usage_failure(OPTION("contact-edits") " requires " OPTION(
                             "method") " fit: the published method does not use contacts",
                         "omit " OPTION("method"));
  }
  if (!options.part.frames.empty() && (options.part.start_s >= 0.0 || options.part.end_s >= 0.0)) {
    return usage_failure(OPTION("frames") " and " OPTION("start") "/" OPTION(
                             "end") " both choose a part of the clip",
                         kOneOfThem);
  }
  return {};
}

// A fit is solved at the rates of its files (solved_rates), and some formats have their own.
Result<void> check_rate(const Options& options) {
  const auto& formats = options.save.formats;
  const TimeOptions usual;
  if (options.solve.method != Method::kFit || formats.empty() || options.time.fps == usual.fps ||
      options.time.fps == options.save.npz_fps ||
      !std::ranges::all_of(formats, format_has_own_rate)) {
    return {};
  }
  return usage_failure(
      OPTION("fps") " has no effect on " + std::string(format_name(formats.front())),
      OPTION("npz-fps") " N sets the rate of this format");
}

Result<void> check_options(const Options& options) {
  TRY(check_solving_options(options));
  TRY(check_rate(options));
  TRY(check_human_options(options.human));
  if (!options.human.map.empty()) TRY(check_bone_map(options.human.map));
  const std::string& tpose = options.human.tpose_file;
  if (!tpose.empty()) TRY(read_file(tpose, ErrorKind::kConfig, kMaxTextBytes));
  const std::string& body = options.source.smpl_model;
  if (!body.empty()) TRY(check_readable(body, ErrorKind::kConfig));
  constexpr int kAnyLength = std::numeric_limits<int>::max();
  if (!options.part.frames.empty()) TRY(frame_range_from_text(options.part.frames, kAnyLength));
  if (options.solve.method == Method::kFit) TRY(choose_fit(options, options.solve.fit));
  return {};
}

}  // namespace retarget
