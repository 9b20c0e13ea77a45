#include "batch_fingerprint.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <vector>

#include "fit_run.h"
#include "provenance/hash.h"
#include "retarget/motion_io.h"
#include "retarget/version.h"
#include "robot/find_robot.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// options that name files: their content counts, not their name
constexpr std::array<std::string_view, 8> kFileOptions = {
    "fit-config",    "ik-config", "limits",     "map",
    "robot-profile", "robot-xml", "smpl-model", "tpose-file"};

std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// the hash of the names and contents of a folder's files
Result<std::string> folder_hash(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    if (at->is_regular_file(error)) files.push_back(at->path());
  }
  std::ranges::sort(files);
  Json json = Json::object();
  for (const fs::path& file : files) {
    auto hash = hash_file(file.string(), ErrorKind::kConfig);
    if (!hash) return failure(hash.error());
    json[file.filename().string()] = *hash;
  }
  return hash_bytes(json_text(json));
}

// the model as compiled, with all that it includes
Result<std::string> model_hash(const Robot& robot) {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(robot.model())), '\0');
  mj_saveModel(robot.model(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return hash_bytes(bytes);
}

// what goes into the hash; names of files are added for people afterwards
class Fingerprint {
 public:
  Result<void> add_file(const std::string& role, const std::string& path) {
    if (path.empty()) return {};
    auto hash = hash_file(path, ErrorKind::kConfig);
    if (!hash) return failure(hash.error());
    hashed["files"][role] = *hash;
    paths[role] = path;
    return {};
  }

  Json hashed = Json::object();
  Json paths = Json::object();
};

Result<void> add_options(const BatchOptions& options, Fingerprint& print) {
  std::error_code ignored;
  for (const auto& [name, values] : options.deciding) {
    // the mapping that is taken is hashed below, whether it is named or the robot's own
    if (name == "ik-config") continue;
    const bool names_file = std::ranges::find(kFileOptions, name) != kFileOptions.end() &&
                            values.size() == 1 && fs::is_regular_file(values.front(), ignored);
    if (names_file) {
      if (auto added = print.add_file("--" + name, values.front()); !added) return added;
    } else {
      print.hashed["options"][name] = values.size() == 1 ? Json(values.front()) : Json(values);
    }
  }
  return {};
}

// what the options mean, where one that is given may say the same as one that is not
Result<void> resolve_options(const RunOptions& run, const RobotSetup& setup, Fingerprint& print) {
  Json& options = print.hashed["options"];
  if (run.formats.empty()) options["format"] = format_name(MotionFormat::kCsv);
  if (options.contains("limits")) options["limits"] = setup.limits.name;
  options["dof"] = setup.robot->variant().name;
  if (run.method != "fit") return {};
  const auto fit = fit_options(run);
  if (!fit) return failure(fit.error());
  options["window"] = fit->window;
  return {};
}

// soles, and shapes in the place of meshes: both may have been found in meshes, which the model as
// compiled has lost. The model's own shapes are in its hash.
Result<std::string> soles_hash(const Robot& robot) {
  Json json = Json::array();
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      json.push_back({sole.body, point.x(), point.y(), point.z()});
    }
  }
  for (const CollisionShape& shape : robot.collision_shapes()) {
    if (shape.geom >= 0) continue;
    const Eigen::Vector3d& place = shape.body_from_shape.translation;
    const Eigen::Quaterniond& turn = shape.body_from_shape.rotation;
    const Eigen::Vector3d& size = shape.half_size;
    json.push_back({static_cast<int>(shape.type), shape.body, place.x(), place.y(), place.z(),
                    turn.w(), turn.x(), turn.y(), turn.z(), shape.radius, shape.half_length,
                    size.x(), size.y(), size.z()});
  }
  return hash_bytes(json_text(json));
}

Result<void> add_robot(const RunOptions& run, const RobotSetup& setup, const fs::path& data_folder,
                       Fingerprint& print) {
  const auto model = model_hash(*setup.robot);
  if (!model) return failure(model.error());
  print.hashed["robot"] = setup.robot->name();
  print.hashed["model"] = *model;
  auto soles = soles_hash(*setup.robot);
  if (!soles) return failure(soles.error());
  print.hashed["soles"] = std::move(*soles);
  if (run.robot_xml.empty()) {
    const auto files = find_robot(run.robot, data_folder / "robots");
    if (!files) return failure(files.error());
    if (auto added = print.add_file("profile", files->profile.string()); !added) return added;
  }
  const RobotMappings& mappings = setup.mappings;
  if (auto added = print.add_file("mapping", mappings.of_lafan1.file); !added) return added;
  return mappings.of_others ? print.add_file("mapping_of_others", mappings.of_others->file)
                            : Result<void>();
}

}  // namespace

Result<BatchFingerprint> batch_fingerprint(const BatchOptions& options, const RunOptions& run,
                                           const RobotSetup& setup, const fs::path& data_folder) {
  Fingerprint print;
  print.hashed["tool"] = version_text();
  if (auto added = add_options(options, print); !added) return failure(added.error());
  if (auto resolved = resolve_options(run, setup, print); !resolved) {
    return failure(resolved.error());
  }
  if (auto added = add_robot(run, setup, data_folder, print); !added) {
    return failure(added.error());
  }
  const auto dialects = folder_hash(data_folder / "configs" / "skeletons");
  if (!dialects) return failure(dialects.error());
  print.hashed["skeletons"] = *dialects;
  const auto gates = folder_hash(data_folder / "configs" / "quality");
  if (!gates) return failure(gates.error());
  print.hashed["quality"] = *gates;

  auto hash = hash_bytes(json_text(print.hashed));
  if (!hash) return failure(hash.error());
  Json shown = {{"options_hash", *hash}};
  shown.update(print.hashed);
  shown["paths"] = print.paths;
  return BatchFingerprint{std::move(*hash), json_text(shown, 2)};
}

}  // namespace retarget::cli
