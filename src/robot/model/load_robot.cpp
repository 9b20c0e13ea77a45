#include <tinyxml2.h>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/json.h"
#include "base/parse_xml.h"
#include "base/try.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/load_robot.h"
#include "robot/model/load_model.h"
#include "robot/model/load_profile.h"

namespace retarget {
namespace {

// Reads only "base" from a profile, which must be known before the robot is loaded. Faults of the
// file are reported later, when the whole profile is read.
bool says_fixed_base(const std::string& profile_path) {
  if (profile_path.empty()) return false;
  const auto json = load_json(profile_path);
  if (!json || !json->is_object()) return false;
  const auto base = json->find("base");
  return base != json->end() && *base == "fixed";
}

}  // namespace

Result<std::shared_ptr<const Robot>> load_robot_files(const std::string& model_path,
                                                      const std::string& profile_path,
                                                      RobotBase base) {
  const bool fixed = base == RobotBase::kFixed || says_fixed_base(profile_path);
  ModelChanges changes;
  changes.float_base = fixed;
  TRY_ASSIGN(auto loaded, load_model(model_path, changes));
  TRY(check_robot_joints(*loaded.model, model_path));
  RobotProfile bare;
  bare.name = std::filesystem::path(model_path).stem().string();
  // The stem of a file such as `...xml` is not a usable folder name.
  if (!is_plain_name(bare.name)) bare.name = "model";
  bare.coupled_joints = std::move(loaded.couplings);
  bare.fixed_base = fixed;
  auto robot =
      std::make_shared<Robot>(std::move(loaded.model), std::move(bare), std::move(loaded.warnings));
  if (profile_path.empty()) return robot;
  TRY_ASSIGN(auto profile, load_profile(profile_path, *robot));
  if (profile.coupled_joints.empty()) profile.coupled_joints = robot->profile().coupled_joints;
  if (fixed) {
    profile.fixed_base = true;
    profile.soles.clear();
  }
  robot->set_profile(std::move(profile));
  return robot;
}

std::map<std::string, JointCoupling> urdf_couplings(const std::string& path) {
  std::map<std::string, JointCoupling> couplings;
  const auto text = read_file(path, ErrorKind::kConfig);
  if (!text) return couplings;
  tinyxml2::XMLDocument document;
  if (!parse_xml(text->view(), document)) {
    return couplings;
  }
  const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return couplings;
  for (const auto* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const auto* mimic = joint->FirstChildElement("mimic");
    const char* name = joint->Attribute("name");
    const char* leader = mimic == nullptr ? nullptr : mimic->Attribute("joint");
    if (name == nullptr || leader == nullptr) continue;
    JointCoupling coupling{leader, mimic->DoubleAttribute("multiplier", 1.0),
                           mimic->DoubleAttribute("offset", 0.0)};
    if (!std::isfinite(coupling.ratio) || !std::isfinite(coupling.offset)) continue;
    couplings[name] = std::move(coupling);
  }
  return couplings;
}

}  // namespace retarget
