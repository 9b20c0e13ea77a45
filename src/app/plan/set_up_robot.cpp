#include "app/plan/set_up_robot.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/plan/robot_source.h"
#include "base/faults.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/kinematic_tree.h"
#include "retarget/load.h"
#include "retarget/load_robot.h"
#include "retarget/option_table.h"
#include "retarget/retargeting_config.h"
#include "retarget/text.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/check_offsets.h"
#include "solve/targets/targets.h"
#include "solve/targets/trunk_aim.h"

namespace retarget {
namespace {

struct WeightFactor {
  const char* name;
  double FitOptions::*weight;
  double factor;
};

// docs/fit.md, "Motions for policies", has the measurements.
constexpr std::array<WeightFactor, 7> kTrackingFactors = {
    {{"smoothness_leg", &FitOptions::smoothness_leg, 2.0},
     {"smoothness_arm", &FitOptions::smoothness_arm, 2.0},
     {"smoothness_wrist", &FitOptions::smoothness_wrist, 2.0},
     {"smoothness_root_position", &FitOptions::smoothness_root_position, 5.0 / 9.0},
     {"smoothness_root_reference", &FitOptions::smoothness_root_reference, 0.0},
     {"smoothness_root_rotation", &FitOptions::smoothness_root_rotation, 2.0},
     {"limb_smoothing_time", &FitOptions::limb_smoothing_time, 0.0}}};

// Rejects contacts that would end as soon as they begin.
Result<void> check_contact_bounds(const FitOptions& fit, const std::string& file) {
  struct Bounds {
    const char *begin, *end;
    double begins, ends;
  };
  const std::array<Bounds, 2> both = {
      {{"contact_speed", "contact_release_speed", fit.contact_speed, fit.contact_release_speed},
       {"contact_height", "contact_release_height", fit.contact_height,
        fit.contact_release_height}}};
  for (const Bounds& of : both) {
    if (of.ends >= of.begins) continue;
    const std::string message = fmt::format("\"{}\" is {}, below \"{}\", which is {}", of.end,
                                            of.ends, of.begin, of.begins);
    const char* const hint = "a contact begins below the second value and ends above the first";
    return file.empty() ? usage_failure(message, hint) : config_failure(file, message, hint);
  }
  return {};
}

// Rejects terms that are both enabled and disabled.
Result<void> check_terms(const SolveOptions& solve) {
  for (const std::string& name : solve.with) {
    if (std::ranges::find(solve.without, name) == solve.without.end()) continue;
    return usage_failure(
        OPTION("with") " and " OPTION("without") " both name the term \"" + name + "\"",
        "give only one of them");
  }
  return {};
}

// Whether a member of the fit's options was given, also with its default value.
bool is_given(const SolveOptions& options, const char* name) {
  return std::ranges::find(options.fit_given, name) != options.fit_given.end();
}

}  // namespace

namespace fs = std::filesystem;

namespace {

// Sets the options of the fit that a preset (SolveOptions::purpose) chooses. Options that
// SolveOptions::fit changes are kept. The options file and terms given by name are applied
// afterwards and take precedence.
void apply_preset(const SolveOptions& options, FitOptions& fit) {
  if (options.purpose != Purpose::kTracking) return;
  const FitOptions usual;
  for (const auto& [name, weight, factor] : kTrackingFactors) {
    if (!is_given(options, name) && options.fit.*weight == usual.*weight) fit.*weight *= factor;
  }
  // Also in a scene and for the motion of a robot.
  if (options.fit.dynamics && !is_given(options, "dynamics")) fit.dynamics = true;
}

}  // namespace

Result<FitOptions> choose_fit(const Options& options, FitOptions fit) {
  const SolveOptions& solve = options.solve;
  fit.decimals = options.save.precision;  // The limits hold for the written values.
  // In a scene, hands and feet would reach surfaces with jolts (docs/world.md).
  const bool has_scene = !solve.scene.empty() || !solve.terrain.empty();
  if (has_scene && !is_given(solve, "dynamics")) fit.dynamics = false;
  apply_preset(solve, fit);
  if (!solve.fit_config.empty()) {
    TRY_ASSIGN(const auto file, read_file(solve.fit_config, ErrorKind::kConfig, kMaxTextBytes));
    TRY_ASSIGN(fit, parse_fit_options(file.view(), solve.fit_config, fit));
  }
  if (solve.fit_window_s > 0.0) fit.window = solve.fit_window_s;
  TRY(check_contact_bounds(fit, solve.fit_config));
  TRY(check_terms(solve));
  TRY(set_terms(fit, solve.with, true));
  TRY(set_terms(fit, solve.without, false));
  return fit;
}

const ResolvedConfig& RobotSetup::config_for(const HumanInClip& human) const {
  return config_of_others && !human.is_lafan1() ? *config_of_others : config;
}

Result<void> check_has_contacts(const Robot& robot) {
  if (!robot.fixed_base()) return {};
  return usage_failure("the base of the robot is fixed, so the motion has no contacts",
                       "omit " OPTION("contacts") " and " OPTION("contact-edits"));
}

bool is_config_by_name(const std::string& config, const LoadedRobot& robot,
                       const SolveOptions& solve) {
  return robot.profile.empty() && solve.ik_config.empty() &&
         fs::path(config).parent_path() == fs::path(robot.data_folder) / "configs";
}

namespace {

// The error for a published configuration that has the name of a robot but does not fit it.
Failure other_robot(Error error, const Robot& robot) {
  error.message = fmt::format(
      "no retargeting configuration for the robot \"{}\", and the published one of that name does "
      "not fit: {}",
      robot.name(), error.message);
  error.hint = OPTION("ik-config") " FILE uses your own retargeting configuration; retarget robots "
               "add creates a robot with one";
  return failure(std::move(error));
}

void doubt_offsets(const Robot& robot, RobotSetup& setup) {
  const ResolvedConfig* of_others = setup.config_of_others ? &*setup.config_of_others : nullptr;
  for (const ResolvedConfig* config : {&std::as_const(setup.config), of_others}) {
    if (config == nullptr) continue;
    std::string wrong = wrong_offsets(robot, *config);
    if (!wrong.empty()) setup.doubts.push_back({0, 0, std::move(wrong)});
  }
}

}  // namespace

Result<RobotSetup> set_up_robot(LoadedRobot loaded, const Options& options) {
  TRY(check_solving_options(options));
  const Robot& robot = *loaded.robot;
  const SolveOptions& solve = options.solve;
  if (!options.save.contacts.empty() || !solve.contact_edits.empty()) {
    TRY(check_has_contacts(robot));
  }
  if (!options.save.scene_out.empty() && robot.fixed_base()) {
    return usage_failure("the base of the robot is fixed, so the motion has no scene",
                         "omit " OPTION("scene-out"));
  }
  RobotSetup setup;
  // The published method has its own, tighter limit set for some robots.
  const std::string method(enum_name(solve.method));
  TRY_ASSIGN(setup.limits,
             load_limits(robot, solve.limits.empty() ? robot.limits_for(method) : solve.limits));
  TRY_ASSIGN(const ConfigFiles files,
             find_configs(solve.ik_config, solve.method, fs::path(loaded.model).parent_path(),
                          loaded.data_folder, fs::path(robot.name()).filename().string()));
  auto config = load_config(files.of_lafan1, robot);
  if (!config && is_config_by_name(files.of_lafan1, loaded, solve)) {
    return other_robot(config.error(), robot);
  }
  TRY_ASSIGN(setup.config, std::move(config));
  if (!files.of_others.empty()) {
    TRY_ASSIGN(setup.config_of_others, load_config(files.of_others, robot));
  }
  doubt_offsets(robot, setup);
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

std::string chosen_travel(const SolveOptions& options) {
  if (!options.travel.empty()) return options.travel;
  // The scene does not move with a scaled path.
  return options.purpose == Purpose::kTracking && options.scene.empty() ? "auto" : "";
}

namespace {

bool is_of_arm(Bone bone) {
  const std::optional<LimbBone> part = limb_bone(bone);
  return part == LimbBone::kArm || part == LimbBone::kForeArm || part == LimbBone::kHand;
}

// Returns the task of the chest. If the base itself carries the arms and follows the hips, it
// represents the chest, with the rotation that the chest's bone has in the T-pose.
ConfigTask chest_of(const ResolvedConfig& config) {
  if (const ConfigTask* torso = torso_task(config); torso != nullptr && torso->body >= 0) {
    return *torso;
  }
  ConfigTask chest;
  chest.body = config.root_body;
  chest.bone = Bone::kSpine2;
  const Eigen::Quaterniond bone_from_hips =
      Eigen::Quaterniond(canonical_t_pose(chest.bone)).conjugate() *
      Eigen::Quaterniond(canonical_t_pose(config.root_bone));
  const ConfigTask* root = config.find_task(config.root_bone);
  chest.rotation_offset = bone_from_hips;
  if (root != nullptr) chest.rotation_offset = bone_from_hips * root->rotation_offset;
  chest.rotation_offset.normalize();
  return chest;
}

// Sets the weights of other tasks to zero but keeps their rows, because they also assign bodies.
Result<void> keep_arms(const Robot& robot, ResolvedConfig& config) {
  ConfigTask chest = chest_of(config);
  chest.position_weight = chest.rotation_weight = 0.0;
  bool has_arm = false;
  for (ResolvedConfig::Table& table : config.match_tables) {
    for (ConfigTask& task : table.tasks) {
      task.position_weight = 0.0;
      if (!is_of_arm(task.bone)) task.rotation_weight = 0.0;
      has_arm = has_arm || (table.used && task.has_weight());
    }
  }
  if (!has_arm) {
    return config_failure(config.file, "no arm of " + robot.name() + " follows an arm of the human",
                          "without " OPTION("follow") " arms, the whole robot follows");
  }
  if (config.find_task(chest.bone) == nullptr) config.match_tables[0].tasks.push_back(chest);
  config.root_bone = chest.bone;
  config.root_body = chest.body;
  return {};
}

// Marks the links of each arm: links that carry, or hang from, a body that follows the arm (such as
// fingers). A link that carries both arms belongs to the trunk.
void mark_arms(const Robot& robot, const ResolvedConfig& config,
               std::vector<std::array<bool, 2>>& sides_of_link) {
  const KinematicTree& tree = robot.tree();
  for (const ResolvedConfig::Table& table : config.match_tables) {
    for (const ConfigTask& task : table.tasks) {
      if (!is_of_arm(task.bone) || task.body < 0) continue;
      const int end = tree.attachment(task.body).link;
      const std::size_t side = side_of(task.bone) == Side::kLeft ? 0 : 1;
      for (int link = 1; end > 0 && link < static_cast<int>(tree.links().size()); ++link) {
        if (!tree.carries(link, end) && !tree.carries(end, link)) continue;
        sides_of_link[static_cast<std::size_t>(link)][side] = true;
      }
    }
  }
}

}  // namespace

Result<void> follow_arms_alone(const Robot& robot, RobotSetup& setup) {
  const auto& links = robot.tree().links();
  std::vector<std::array<bool, 2>> sides_of_link(links.size());
  TRY(keep_arms(robot, setup.config));
  mark_arms(robot, setup.config, sides_of_link);
  if (setup.config_of_others) {
    TRY(keep_arms(robot, *setup.config_of_others));
    mark_arms(robot, *setup.config_of_others, sides_of_link);
  }
  const std::vector<double> standing = robot.zero_configuration();
  for (std::size_t joint = 0; joint < robot.joints().size(); ++joint) {
    const int link = robot.tree().link_of_joint(static_cast<int>(joint));
    const auto& sides = sides_of_link[static_cast<std::size_t>(std::max(link, 0))];
    if (link > 0 && sides[0] != sides[1]) continue;
    double &lower = setup.limits.lower[joint], &upper = setup.limits.upper[joint];
    const auto address = static_cast<std::size_t>(robot.joints()[joint].qpos_address);
    lower = upper = std::clamp(standing[address], lower, upper);
  }
  return {};
}

std::vector<SummaryLine> follow_lines(const LoadedRobot& robot, const LimitSet& limits) {
  if (robot.choice.follow != Follow::kArms) return {};
  const std::size_t held = locked_joints(*robot.robot, limits).size();
  return {{"follows", fmt::format("{} of the arms, relative to the chest; the base and {} keep the "
                                  "standing pose for another controller",
                                  count_text(robot.robot->output_joints().size() - held, "joint"),
                                  count_text(held, "joint"))}};
}

std::vector<SummaryLine> RobotSetup::follow_lines() const {
  return retarget::follow_lines(loaded, limits);
}

std::vector<std::string> locked_joints(const Robot& robot, const LimitSet& limits) {
  std::vector<std::string> names;
  for (const int joint : robot.output_joints()) {
    const auto i = static_cast<std::size_t>(joint);
    if (limits.lower[i] == limits.upper[i]) names.push_back(robot.joints()[i].name);
  }
  return names;
}

Result<double> foot_path_scale(const Clip& clip, const Plan& plan) {
  HumanPoser poser(clip, plan.human.calibration);
  TRY_ASSIGN(const TargetBuilder targets,
             located(make_targets(poser.info(), poses_of(poser), *plan.robot.robot, plan.config,
                                  plan.scale),
                     clip.name()));
  return path_scales(targets).foot;
}

}  // namespace retarget
