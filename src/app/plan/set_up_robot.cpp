#include "app/plan/set_up_robot.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include "app/plan/follow_arms.h"
#include "app/plan/robot_source.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {
namespace {

struct WeightFactor {
  const char* name;
  double FitOptions::*weight;
  double factor;
};

// docs/fit.md, "Motions for policies", has the measurements.
constexpr std::array<WeightFactor, 6> kTrackingFactors = {
    {{"smoothness_leg", &FitOptions::smoothness_leg, 2.0},
     {"smoothness_arm", &FitOptions::smoothness_arm, 2.0},
     {"smoothness_wrist", &FitOptions::smoothness_wrist, 2.0},
     {"smoothness_root_position", &FitOptions::smoothness_root_position, 2.0 / 3.0},
     {"smoothness_root_reference", &FitOptions::smoothness_root_reference, 0.0},
     {"smoothness_root_rotation", &FitOptions::smoothness_root_rotation, 2.0}}};

// Whether a member of the fit's options was given, also with its default value.
bool is_given(const SolveOptions& options, const char* name) {
  return std::ranges::find(options.fit_given, name) != options.fit_given.end();
}

}  // namespace

namespace fs = std::filesystem;

Result<FitOptions> choose_fit(const Options& options, FitOptions fit) {
  const SolveOptions& solve = options.solve;
  // The limits hold for the written values; lower precision than this is not useful.
  constexpr int kMinDecimals = 3;
  fit.decimals = std::max(kMinDecimals, options.save.precision);
  // In a scene, hands and feet would reach surfaces with jolts (docs/world.md).
  const bool has_scene = !solve.scene.empty() || !solve.terrain.empty();
  if (has_scene && !is_given(solve, "dynamics")) fit.dynamics = false;
  apply_preset(solve, fit);
  if (!solve.fit_config.empty()) {
    TRY_ASSIGN(const auto file, read_file(solve.fit_config, ErrorKind::kConfig, kMaxTextBytes));
    TRY_ASSIGN(fit, parse_fit_options(file.view(), solve.fit_config, fit));
  }
  if (solve.fit_window_s > 0.0) fit.window = solve.fit_window_s;
  TRY(set_terms(fit, solve.with, true));
  TRY(set_terms(fit, solve.without, false));
  return fit;
}

const ResolvedConfig& RobotSetup::config_for(const HumanInClip& human) const {
  return config_of_others && !human.is_lafan1() ? *config_of_others : config;
}

Result<RobotSetup> set_up_robot(LoadedRobot loaded, const Options& options) {
  TRY(check_solving_options(options));
  const Robot& robot = *loaded.robot;
  const SolveOptions& solve = options.solve;
  RobotSetup setup;
  // The published method has its own, tighter limit set for some robots.
  const std::string method(enum_name(solve.method));
  TRY_ASSIGN(setup.limits,
             load_limits(robot, solve.limits.empty() ? robot.limits_for(method) : solve.limits));
  TRY_ASSIGN(const ConfigFiles files,
             find_configs(solve.ik_config, solve.method, fs::path(loaded.model).parent_path(),
                          loaded.data_folder, fs::path(robot.name()).filename().string()));
  TRY_ASSIGN(setup.config, load_config(files.of_lafan1, robot));
  if (!files.of_others.empty()) {
    TRY_ASSIGN(setup.config_of_others, load_config(files.of_others, robot));
  }
  if (loaded.choice.follow == Follow::kArms) TRY(follow_arms_alone(robot, setup));
  if (solve.method == Method::kFit) {
    TRY_ASSIGN(setup.fit, choose_fit(options, solve.fit));
    FitOptions of_robots = fit_of_robot_motions(solve.fit);
    // A program computed the motion of a robot, so by default, the dynamics stage does not change
    // it.
    if (!is_given(solve, "dynamics")) of_robots.dynamics = false;
    TRY_ASSIGN(setup.fit_of_robots, choose_fit(options, of_robots));
  }
  setup.loaded = std::move(loaded);
  return setup;
}

void apply_preset(const SolveOptions& options, FitOptions& fit) {
  if (options.purpose != Purpose::kTracking) return;
  const FitOptions usual;
  for (const auto& [name, weight, factor] : kTrackingFactors) {
    if (!is_given(options, name) && options.fit.*weight == usual.*weight) fit.*weight *= factor;
  }
  // Also in a scene and for the motion of a robot.
  if (options.fit.dynamics && !is_given(options, "dynamics")) fit.dynamics = true;
}

std::string chosen_travel(const SolveOptions& options) {
  if (!options.travel.empty()) return options.travel;
  return options.purpose == Purpose::kTracking ? "auto" : "";
}

}  // namespace retarget
