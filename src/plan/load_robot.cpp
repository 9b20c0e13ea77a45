#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "anatomy/bare_robot.h"
#include "base/data_folder.h"
#include "base/file.h"
#include "base/number_text.h"
#include "base/option_name.h"
#include "base/try.h"
#include "plan/check_options.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "robot/find_robot.h"
#include "robot/load_robot.h"
#include "robot/variant.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

Result<void> check_model_file(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {};
  const fs::path model = fs::path(path) / "model.xml";
  return config_failure(
      path, "expected a robot's model, found a directory",
      is_file(model)
          ? OPTION("robot") " " + path + " takes a robot's folder; its model is " + model.string()
          : "name the MJCF or URDF in it");
}

void warn_of_guessed_soles(LoadedRobot& loaded) {
  loaded.warnings.push_back(
      {0, 0,
       "the model does not show where the soles are: they are guessed from the legs' lengths, "
       "and feet may float or sink by centimetres"});
}

// a motion whose feet nobody knows floats or sinks, so soles are looked for in the model
void find_soles(const RobotChoice& choice, LoadedRobot& loaded) {
  const bool may_have_profile = !choice.model.empty() && choice.profile.empty();
  const std::string remedy =
      std::string("a profile defines them (docs/robots.md)") +
      (may_have_profile ? ": " OPTION("robot-profile") " FILE" : ", this robot's does not");
  auto completed = complete_bare_robot(*loaded.robot, loaded.model);
  const bool stands = loaded.robot->fixed_base();
  if (!completed && stands) return;
  if (!completed) {
    loaded.warnings.push_back(
        {0, 0,
         fmt::format("the robot's soles are not known, so its feet may float or sink; {}; they "
                     "were looked for in the model: {}",
                     remedy, completed.error().message)});
    return;
  }
  if (!stands) loaded.notes.push_back({"soles", completed->note + "; " + remedy});
  if (completed->guessed) warn_of_guessed_soles(loaded);
  if (const int parts = completed->shapeless; parts > 0) {
    loaded.warnings.push_back(
        {0, 0,
         fmt::format("the model has neither a sphere, capsule or box nor a mesh for {} part{} of "
                     "its body, and nothing keeps these out of each other and the floor; retarget "
                     "robots add makes shapes for them",
                     parts, parts == 1 ? "" : "s")});
  }
  if (!completed->overlaps.empty()) {
    loaded.notes.push_back(
        {"shapes", fmt::format("{} of the model overlap whatever the robot does, and {}: {}",
                               count_text(completed->overlaps.size(), "pair"),
                               completed->overlaps.size() == 1 ? "its contact is no fault"
                                                               : "their contacts are no faults",
                               fmt::join(completed->overlaps, "; "))});
  }
  loaded.robot = std::move(completed->robot);
}

}  // namespace

Result<LoadedRobot> load_robot(const RobotChoice& choice, const DataFolder& data_folder,
                               Soles soles) {
  TRY(check_robot_choice(choice));
  const auto& chosen = data_folder.chosen;
  TRY_ASSIGN(const fs::path folder,
             find_data_folder(chosen.empty() ? std::nullopt : std::optional(chosen),
                              data_folder.installed));
  TRY(check_model_file(choice.model));
  LoadedRobot loaded{nullptr,        choice,          choice.name, choice.model,
                     choice.profile, folder.string(), {},          {}};
  if (choice.model.empty()) {
    TRY_ASSIGN(const RobotFiles files, find_robot(choice.name, folder / "robots"));
    loaded.name = loaded.choice.name = files.name;
    loaded.model = files.model.string();
    loaded.profile = files.profile.string();
  }
  TRY_ASSIGN(loaded.robot, load_robot_files(loaded.model, loaded.profile, choice.base));
  const bool bare =
      loaded.robot->fixed_base() ? loaded.profile.empty() : loaded.robot->profile().soles.empty();
  if (soles == Soles::kFound && bare) find_soles(choice, loaded);
  if (loaded.robot->profile().soles_estimated && !loaded.robot->fixed_base()) {
    loaded.notes.push_back({"soles", loaded.robot->profile().soles_source + ": " + loaded.profile});
    warn_of_guessed_soles(loaded);
  }
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

}  // namespace retarget
