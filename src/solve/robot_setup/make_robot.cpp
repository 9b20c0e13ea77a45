#include "retarget/make_robot.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/try.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/overlaps.h"
#include "robot/anatomy/robot_hands.h"
#include "robot/anatomy/shapes.h"
#include "solve/robot_setup/check_profile.h"
#include "solve/robot_setup/check_robot.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/describe_robot.h"
#include "solve/robot_setup/format_model.h"
#include "solve/robot_setup/import_robot.h"
#include "solve/robot_setup/self_test.h"
#include "solve/robot_setup/t_pose.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Removes the model's joint couplings except those of hands. Other joints become independent.
void keep_couplings_of_hands(const RobotHands& hands, const Robot& robot, RobotProfile& profile,
                             std::vector<std::string>& notes) {
  for (const std::string& joint : couplings_outside(hands, robot)) {
    notes.push_back(dropped_coupling_text(robot, joint));
    profile.coupled_joints.erase(joint);
  }
}

Json couplings_json(const RobotProfile& profile) {
  Json all = Json::object();
  for (const auto& [name, coupling] : profile.coupled_joints) {
    all[name] = {
        {"joint", coupling.leader}, {"ratio", coupling.ratio}, {"offset", coupling.offset}};
  }
  return all;
}

Json contacts_json(const Robot& robot, const std::vector<std::pair<int, int>>& contacts) {
  Json pairs = Json::array();
  for (const auto& [a, b] : contacts) {
    pairs.push_back({robot.bodies()[a].name, robot.bodies()[b].name});
  }
  return pairs;
}

Json soles_json(const Robot& robot, const std::vector<Sole>& soles) {
  Json all = Json::object();
  for (const Sole& sole : soles) {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : sole.points) {
      points.push_back({rounded(point.x(), 5), rounded(point.y(), 5), rounded(point.z(), 5)});
    }
    all[sole.side] = {
        {"body", robot.bodies()[sole.body].name}, {"points", points}, {"labels", sole.labels}};
  }
  return all;
}

std::string profile_text(const Robot& robot, const std::string& source, const TPose& t_pose,
                         const RobotShapes& shapes, const AllowedContacts& contacts,
                         const std::map<std::string, double>& speeds) {
  Json json;
  json["name"] = robot.name();
  json["description"] = robot.name() + ", " + std::to_string(robot.joints().size()) + " joints";
  json["source"] = source;
  if (robot.fixed_base()) json["base"] = "fixed";
  json["joint_order"] = robot.joint_names();
  json["speed_limits"] = Json::object();
  for (const RobotJoint& joint : robot.joints()) {
    const auto speed = speeds.find(joint.name);
    if (speed != speeds.end()) json["speed_limits"][joint.name] = speed->second;
  }
  json["speed_limits_source"] = json["speed_limits"].empty()
                                    ? "none published: the default for all joints"
                                    : "the URDF's velocity limits";
  json["default_speed_limit"] = kDefaultSpeedLimit;
  if (!robot.profile().coupled_joints.empty()) {
    json["coupled_joints"] = couplings_json(robot.profile());
  }
  json["t_pose"] = Json::object();
  for (const RobotJoint& joint : robot.joints()) {
    const double position = rounded(t_pose.qpos[joint.qpos_address], 4);
    if (position != 0.0) json["t_pose"][joint.name] = position;
  }
  json["soles"] = soles_json(robot, shapes.soles);
  json["soles_source"] = shapes.sole_note;
  json["soles_estimated"] = shapes.sole_source == ShapeSource::kEstimated;
  json["allowed_self_contact"] = contacts_json(robot, contacts.pairs);
  std::vector<std::string> frames = joint_frames(robot);
  std::erase(frames, std::string());
  if (!frames.empty()) json["joint_frames"] = frames;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name,
                             RobotBase base) {
  MadeRobot made;
  made.name = name;
  RETARGET_TRY_ASSIGN(auto imported, import_robot(model_path, name, base));
  Robot& robot = *imported.robot;
  made.notes = std::move(imported.notes);
  made.notes.insert(made.notes.end(), robot.warnings().begin(), robot.warnings().end());
  for (RobotFinding& finding : model_findings(robot)) {
    if (finding.fault) return config_failure(model_path, std::move(finding.text));
    made.notes.push_back(std::move(finding.text));
  }
  RETARGET_TRY_ASSIGN(const auto limbs, find_limbs(robot, model_path));
  RETARGET_TRY(check_closed_chains(imported, limbs, model_path, made.notes));
  RobotProfile profile = robot.profile();
  keep_couplings_of_hands(find_hands(robot, limbs), robot, profile, made.notes);
  robot.set_profile(std::move(profile));
  const RobotHands hands = find_hands(robot, limbs);
  const RobotShapes shapes = find_shapes(robot, limbs, mesh_points(robot, model_path));
  const TPose t_pose = solve_t_pose(robot, limbs);
  if (const auto fault = t_pose_fault(robot, t_pose)) {
    return config_failure(model_path, *fault, kTPoseHint);
  }
  std::vector<CollisionShape> all_shapes;
  for (const RoughShape& rough : shapes.shapes) all_shapes.push_back(rough.shape);
  robot.set_collision_shapes(std::move(all_shapes));
  const std::vector<std::vector<double>> poses = {reference_configuration(robot), t_pose.qpos};
  const AllowedContacts contacts = find_allowed_contacts(robot, limbs, imported.excluded, poses);
  std::vector<std::string> overlaps;
  for (const ModelOverlap& each : contacts.overlaps) overlaps.push_back(overlap_text(robot, each));
  if (!overlaps.empty()) made.notes.push_back(kOverlapsIgnored + list_overlaps(overlaps));
  DeriveOptions options;
  options.sole_height = shapes.ankle_height;
  const RetargetingConfig config = derive_config(robot, limbs, options);
  RETARGET_TRY_ASSIGN(const ResolvedConfig resolved, resolve_config(config, robot));
  // Fails on all findings that `robots check` would report as errors.
  for (RobotFinding& finding : check_robot(robot, &config)) {
    if (finding.fault) return config_failure(model_path, std::move(finding.text));
  }
  RETARGET_TRY_ASSIGN(const SelfTest test, run_self_test(robot, limbs, resolved));
  const std::map<std::string, double>& speeds = robot.profile().speed_limits;
  const std::string source = fs::path(model_path).filename().string();
  made.model = format_model(robot, name, shapes.shapes);
  made.profile = profile_text(robot, source, t_pose, shapes, contacts, speeds);
  made.config = format_retargeting_config(config);
  const RobotFindings findings{robot,  limbs, t_pose, shapes, overlaps,
                               config, test,  hands,  speeds, source};
  const std::vector<std::string> more = notes_about(findings);
  made.notes.insert(made.notes.end(), more.begin(), more.end());
  made.summary = summary_of(findings);
  made.decisions = decisions_text(findings, made.notes);
  return made;
}

}  // namespace retarget
