#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/data_folder.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/load_robot.h"
#include "retarget/text.h"
#include "robot/anatomy/bare_robot.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/overlaps.h"
#include "solve/targets/check_soles.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

Result<void> check_model_file(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {};
  const fs::path model = fs::path(path) / "model.xml";
  return config_failure(
      path, "expected a robot model, found a directory",
      is_file(model)
          ? OPTION("robot") " " + path + " accepts a robot folder; its model is " + model.string()
          : "name the MJCF or URDF file in it");
}

void warn_of_guessed_soles(LoadedRobot& loaded) {
  loaded.warnings.push_back({0, 0,
                             "the soles are estimated from the leg lengths, so feet may float or "
                             "sink by centimetres"});
}

// Infers soles from the model, because feet with unknown soles float or sink.
void find_soles(const RobotChoice& choice, LoadedRobot& loaded) {
  const bool may_have_profile = !choice.model.empty() && choice.profile.empty();
  const std::string remedy =
      std::string("define them in a profile (docs/robots.md)") +
      (may_have_profile ? ": " OPTION("robot-profile") " FILE" : "; this robot's profile does not");
  auto completed = complete_bare_robot(*loaded.robot, loaded.model);
  const bool stands = loaded.robot->fixed_base();
  if (!completed && stands) return;
  if (!completed) {
    loaded.warnings.push_back({0, 0,
                               fmt::format("the robot's soles are unknown, so its feet may float "
                                           "or sink; {}; the search in the model failed: {}",
                                           remedy, completed.error().message)});
    return;
  }
  if (!stands) loaded.notes.push_back({"soles", completed->note + "; " + remedy});
  if (completed->guessed) warn_of_guessed_soles(loaded);
  if (const int parts = completed->shapeless; parts > 0) {
    loaded.warnings.push_back(
        {0, 0,
         fmt::format(
             "the model has no sphere, capsule, box or mesh for {} part{} of its body, so they may "
             "penetrate each other and the floor; retarget robots add creates shapes for them",
             parts, parts == 1 ? "" : "s")});
  }
  if (!completed->overlaps.empty()) {
    loaded.notes.push_back(
        {"shapes", fmt::format("{} of shapes in the model overlap in all poses; {}: {}",
                               count_text(completed->overlaps.size(), "pair"),
                               completed->overlaps.size() == 1 ? "this contact is ignored"
                                                               : "these contacts are ignored",
                               list_overlaps(completed->overlaps))});
  }
  loaded.robot = std::move(completed->robot);
}

// Rejects a robot with two feet and one sole, and warns of soles that are not at the feet.
Result<void> check_given_soles(LoadedRobot& loaded) {
  const Robot& robot = *loaded.robot;
  if (robot.profile().soles.empty()) return {};
  const auto limbs = find_limbs(robot, loaded.model);
  if (!limbs || !limbs->has_legs) return {};
  SoleFaults faults = check_soles(robot, *limbs);
  if (!faults.missing.empty()) {
    return config_failure(loaded.profile, std::move(faults.missing), missing_sole_hint(robot));
  }
  for (std::string& misplaced : faults.misplaced) {
    loaded.warnings.push_back({0, 0, std::move(misplaced)});
  }
  return {};
}

}  // namespace

Result<LoadedRobot> load_robot(const RobotChoice& choice, const DataFolder& data_folder,
                               Soles soles) {
  TRY(check_robot_choice(choice));
  TRY_ASSIGN(const fs::path folder, find_data_folder(data_folder));
  TRY(check_model_file(choice.model));
  LoadedRobot loaded{nullptr,        choice,          choice.name, choice.model,
                     choice.profile, folder.string(), {},          {}};
  if (choice.model.empty()) {
    TRY_ASSIGN(const RobotFiles files, find_robot(choice.name, robot_folders(folder)));
    if (files.name != choice.name) {
      loaded.notes.push_back({"robot", "\"" + choice.name + "\" is " + files.name});
    }
    if (!files.warning.empty()) loaded.warnings.push_back({0, 0, files.warning});
    loaded.name = loaded.choice.name = files.name;
    loaded.model = files.model.string();
    loaded.profile = files.profile.string();
  }
  // With Follow::kArms, the base stays fixed and the arms follow relative to it.
  const RobotBase base = choice.follow == Follow::kArms ? RobotBase::kFixed : choice.base;
  TRY_ASSIGN(loaded.robot, load_robot_files(loaded.model, loaded.profile, base));
  const bool bare =
      loaded.robot->fixed_base() ? loaded.profile.empty() : loaded.robot->profile().soles.empty();
  if (soles == Soles::kFound && bare) {
    find_soles(choice, loaded);
  } else if (loaded.robot->profile().soles_estimated && !loaded.robot->fixed_base()) {
    loaded.notes.push_back({"soles", loaded.robot->profile().soles_source + ": " + loaded.profile});
    warn_of_guessed_soles(loaded);
  }
  if (soles == Soles::kFound && !bare) TRY(check_given_soles(loaded));
  if (!choice.variant.empty()) {
    TRY_ASSIGN(loaded.robot, robot_variant(loaded.robot, choice.variant));
  }
  for (const std::string& warning : loaded.robot->warnings()) {
    loaded.warnings.push_back({0, 0, warning});
  }
  return loaded;
}

Result<LoadedRobot> load_robot(const std::string& name_or_file) {
  const fs::path ending = fs::path(name_or_file).extension();
  const bool is_model = (ending == ".xml" || ending == ".urdf") && is_file(name_or_file);
  RobotChoice choice;
  (is_model ? choice.model : choice.name) = name_or_file;
  return load_robot(choice);
}

namespace {

constexpr const char* kPublished = "published";
constexpr const char* kDerived = "derived";
constexpr const char* kConfigHint = OPTION(
    "ik-config") " FILE uses your own retargeting configuration; retarget robots add creates a "
    "robot with one";

// An inaccessible file is an error, not a missing file: otherwise another file would replace it.
Result<void> check_look(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::status_known(status)) return {};
  return config_failure(path.string(), "cannot access the file: " + error.message());
}

// Whether this is an installed robot, and not one with the same name from elsewhere.
bool is_of_folders(const fs::path& robot_folder, const RobotFolders& folders) {
  const fs::path parent =
      robot_folder.parent_path().empty() ? fs::path(".") : robot_folder.parent_path();
  std::error_code ignored;
  return std::ranges::any_of(folders, [&](const fs::path& robots) {
    return fs::equivalent(parent, robots, ignored) ||
           fs::equivalent(parent, robots / "unverified", ignored);
  });
}

}  // namespace

bool is_config_kind(const std::string& ik_config) {
  return ik_config == kPublished || ik_config == kDerived;
}

Result<ConfigFiles> find_configs(const std::string& ik_config, Method method,
                                 const fs::path& robot_folder, const fs::path& data_folder,
                                 const std::string& robot) {
  if (!ik_config.empty() && !is_config_kind(ik_config)) return ConfigFiles{ik_config, {}};
  const fs::path own = robot_folder / "ik.json";
  const fs::path published = data_folder / "configs" / ("lafan1_to_" + robot + ".json");
  for (const fs::path& path : {own, published}) {
    TRY(check_look(path));
  }
  if (!ik_config.empty()) {
    const fs::path& chosen = ik_config == kPublished ? published : own;
    const fs::path& other = ik_config == kPublished ? own : published;
    if (is_file(chosen)) return ConfigFiles{chosen.string(), {}};
    return config_failure(
        "",
        "no " + ik_config + " retargeting configuration for the robot \"" + robot + "\": no " +
            chosen.string(),
        is_file(other) ? std::string(OPTION("ik-config") " ") +
                             (ik_config == kPublished ? kDerived : kPublished) +
                             " selects the existing one, " OPTION("ik-config") " FILE your own"
                       : kConfigHint);
  }
  if (method == Method::kGmr && is_file(own) && is_file(published) &&
      is_of_folders(robot_folder, robot_folders(data_folder))) {
    return ConfigFiles{published.string(), own.string()};
  }
  for (const fs::path& path : {own, published}) {
    if (is_file(path)) return ConfigFiles{path.string(), {}};
  }
  return config_failure("",
                        "no retargeting configuration for the robot \"" + robot + "\": neither " +
                            own.string() + " nor " + published.string(),
                        kConfigHint);
}

std::string recorded_name(const fs::path& path, const fs::path& data_folder) {
  const fs::path relative = path.lexically_relative(data_folder);
  const bool below = !relative.empty() && *relative.begin() != "..";
  return below ? relative.generic_string() : path.string();
}

}  // namespace retarget
