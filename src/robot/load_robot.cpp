#include "robot/load_robot.h"

#include <filesystem>
#include <utility>

#include "base/plain_name.h"
#include "base/try.h"
#include "robot/load_model.h"
#include "robot/load_profile.h"

namespace retarget {

Result<std::shared_ptr<const Robot>> load_robot_files(const std::string& model_path,
                                                      const std::string& profile_path) {
  TRY_ASSIGN(auto loaded, load_model(model_path));
  TRY(check_robot_joints(*loaded.model, model_path));
  RobotProfile bare;
  bare.name = std::filesystem::path(model_path).stem().string();
  // of a file as `...xml` nothing is left that a folder could be called
  if (!is_plain_name(bare.name)) bare.name = "model";
  bare.coupled_joints = std::move(loaded.couplings);
  auto robot =
      std::make_shared<Robot>(std::move(loaded.model), std::move(bare), std::move(loaded.warnings));
  if (profile_path.empty()) return robot;
  TRY_ASSIGN(auto profile, load_profile(profile_path, *robot));
  if (profile.coupled_joints.empty()) profile.coupled_joints = robot->profile().coupled_joints;
  robot->set_profile(std::move(profile));
  return robot;
}

}  // namespace retarget
