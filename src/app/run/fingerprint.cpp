#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "app/options/options_json.h"
#include "app/plan/robot_source.h"
#include "app/run/scene_hash.h"
#include "app/run/sidecar.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/file_endings.h"
#include "retarget/fingerprint.h"
#include "retarget/hash.h"
#include "retarget/os.h"
#include "retarget/robot.h"
#include "retarget/version.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Options that differ between clips, or whose targets are hashed instead of their values: the
// robot, its limits, configuration and fit.
constexpr std::array<std::string_view, 12> kTakenByMeaning = {
    "motion", "smpl",      "output",     "robot",  "robot-xml", "robot-profile",
    "dof",    "ik-config", "fit-config", "window", "with",      "without"};

// The file of the retargeting configuration, and whether the user chose it.
constexpr const char* kConfigRole = "mapping";
constexpr const char* kConfigNamed = "ik-config-named";

// The name under which a file that an option names is recorded.
std::string role_of(const Option& row) {
  return row.name == "ik-config" ? kConfigRole : row.name;
}

void set_option(const Option& row, const std::string& text) {
  if (text.empty()) return;
  const auto value = option_value(row, text);
  if (value) static_cast<void>(row.set(*value));
}

std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// Hash of the compiled model, including all of its files.
Result<std::string> model_hash(const Robot& robot) {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(robot.model())), '\0');
  mj_saveModel(robot.model(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return hash_bytes(bytes);
}

// Hash of the soles and of the shapes that replace meshes. Both may be derived from meshes, which
// the compiled model no longer contains. The model's own shapes are part of its hash.
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

// The hashed data. File names are added afterwards for information only.
struct Fingerprint {
  Json hashed = Json::object();
  Json paths = Json::object();

  Result<void> add_file(const std::string& role, const std::string& path) {
    if (path.empty()) return {};
    TRY_ASSIGN(hashed["files"][role], hash_file(path, ErrorKind::kConfig));
    paths[role] = path;
    return {};
  }
};

Result<void> add_options(const Run& run, const RobotSetup& setup, Fingerprint& print) {
  Run copy = run;
  if (copy.options.save.formats.empty()) copy.options.save.formats = {MotionFormat::kCsv};
  std::error_code ignored;
  for (const Option& row : run_table(copy)) {
    if (!is_recorded(row) || std::ranges::count(kTakenByMeaning, row.name) > 0) continue;
    const std::string value = to_text(row.get());
    if (row.info.file != OptionFile::kNone && fs::is_regular_file(value, ignored)) {
      TRY(print.add_file(row.name, value));
    } else {
      print.hashed["options"][row.name] = value;
    }
  }
  print.hashed["options"]["limits"] = setup.limits.name;
  if (run.options.solve.method != Method::kFit) return {};
  FitOptions fit = run.options.source.from_robot.empty() ? setup.fit : setup.fit_of_robots;
  fit.threads = 0;
  print.hashed["fit"] = options_json(fit_table(fit));
  return {};
}

// Adds the shapes of the scene, which may come from other files, and the files of object tracks.
Result<void> add_surroundings(const Run& run, Fingerprint& print) {
  const SolveOptions& solve = run.options.solve;
  if (is_file(solve.scene)) {
    TRY_ASSIGN(print.hashed["scene_shapes"], scene_hash(solve.scene));
  }
  for (const auto& [role, file] : object_track_files(solve)) TRY(print.add_file(role, file));
  return {};
}

// Adds the robot of the source motions.
Result<void> add_source_robot(const Run& run, const RobotSetup& setup, Fingerprint& print) {
  const std::string& name = run.options.source.from_robot;
  if (name.empty()) return {};
  TRY_ASSIGN(const SourceRobot source, load_source_robot(name, {setup.loaded.data_folder}));
  print.hashed["source_robot"] = source.loaded.robot->name();
  TRY_ASSIGN(print.hashed["source_model"], model_hash(*source.loaded.robot));
  TRY_ASSIGN(print.hashed["source_soles"], soles_hash(*source.loaded.robot));
  TRY(print.add_file("source_profile", source.loaded.profile));
  return print.add_file("source_mapping", source.config.file);
}

Result<void> add_robot(const RobotSetup& setup, Fingerprint& print) {
  const Robot& robot = *setup.loaded.robot;
  print.hashed["robot"] = robot.name();
  print.hashed["dof"] = robot.variant().name;
  TRY_ASSIGN(print.hashed["model"], model_hash(robot));
  TRY_ASSIGN(print.hashed["soles"], soles_hash(robot));
  TRY(print.add_file("profile", setup.loaded.profile));
  TRY(print.add_file(kConfigRole, setup.config.file));
  if (setup.config_of_others) {
    TRY(print.add_file("mapping_of_others", setup.config_of_others->file));
  }
  return {};
}

}  // namespace

nlohmann::ordered_json gates_json(const Gates& gates) {
  Json json = Json::object();
  for (const Gate& gate : gates.all()) {
    Json& bounds = json[gate.metric];
    if (gate.min) bounds["min"] = *gate.min;
    if (gate.max) bounds["max"] = *gate.max;
    if (gate.leg) bounds["leg_m"] = *gate.leg;
  }
  return json;
}

Result<RunFingerprint> run_fingerprint(const Run& run, const RunRequest& request,
                                       const RobotSetup& setup) {
  Fingerprint print;
  print.hashed["tool"] = version_text();
  TRY(add_options(run, setup, print));
  TRY(add_surroundings(run, print));
  print.hashed["options"]["sidecar"] = request.sidecar;
  print.hashed["options"]["measured"] = request.measure;
  if (request.dynamics) print.hashed["options"]["dynamics"] = true;
  // A retargeting configuration given by name is scaled differently from the same one found
  // automatically.
  const std::string& config = run.options.solve.ik_config;
  print.hashed["options"][kConfigNamed] = !config.empty() && config != "derived";
  TRY(add_robot(setup, print));
  TRY(add_source_robot(run, setup, print));
  const fs::path configs = fs::path(setup.loaded.data_folder) / "configs";
  TRY_ASSIGN(print.hashed["skeletons"], folder_hash(configs / "skeletons", ""));
  TRY_ASSIGN(print.hashed["quality"], folder_hash(configs / "quality", ""));
  TRY_ASSIGN(std::string hash, hash_bytes(json_text(print.hashed)));
  Json shown = {{"options_hash", hash}};
  shown.update(print.hashed);
  // Gates do not affect motions, so they are not hashed.
  if (request.gates) shown["gates"] = gates_json(*request.gates);
  shown["paths"] = print.paths;
  return RunFingerprint{std::move(hash), json_text(shown, 2)};
}

std::string restore_options(const Json& description, const FindRecorded& find, Run& run) {
  const OptionTable table = rows_for(OptionUse::kShowBatch, run_table(run));
  const Json options = object_at(description, "options"), paths = object_at(description, "paths"),
             hashes = object_at(description, "files");
  std::string changed;
  for (const Option& row : table) {
    const bool is_file = row.info.file != OptionFile::kNone;
    const std::string role = role_of(row);
    if (!is_file || !paths.contains(role)) {
      // Files are recorded separately, with their hashes.
      const std::string text = text_at(options, row.name);
      std::error_code ignored;
      if (is_file &&
          (text.find_first_of(os::kSeparators) != std::string::npos || fs::exists(text, ignored)))
        continue;
      set_option(row, text);
      continue;
    }
    // Without a choice, the configuration is that of the robot.
    const auto named = options.find(kConfigNamed);
    if (role == kConfigRole && (named == options.end() || *named != true)) continue;
    const std::string path = text_at(paths, role), hash = text_at(hashes, role);
    if (path.empty()) continue;
    const std::string found = find(path, hash);
    if (!found.empty()) {
      set_option(row, found);
    } else if (changed.empty()) {
      changed = path;
    }
  }
  run.robot.variant = text_at(description, "dof");
  return changed;
}

ReadingOptions restored_dialect(const Json& description) {
  ReadingOptions reading;
  const Json options = object_at(description, "options");
  if (text_at(options, "format").find("csv-soma") != std::string::npos) return reading;
  if (const std::string is = text_at(options, "csv-degrees"); !is.empty()) {
    reading.angles = is == "true" ? "deg" : "rad";
  }
  if (const std::string is = text_at(options, "csv-centimetres"); !is.empty()) {
    reading.unit = is == "true" ? "cm" : "m";
  }
  if (const std::string is = text_at(options, "csv-quat"); !is.empty()) {
    reading.quaternion = is == "wxyz" ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  }
  return reading;
}

namespace fs = std::filesystem;

Result<std::string> folder_hash(const fs::path& folder, std::string_view ending) {
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  for (const fs::path& file : files_in_folder(folder)) {
    const bool counts = ending.empty() || file.extension() == ending;
    if (!counts || !is_file(file)) continue;
    TRY_ASSIGN(const std::string hash, hash_file(file.string(), ErrorKind::kConfig));
    hasher.update(file.filename().string() + " " + hash + "\n");
  }
  return hasher.finish();
}

Result<std::string> motion_hash(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return folder_hash(path, "");
  TRY_ASSIGN(std::string hash, hash_file(path));
  const std::vector<fs::path> companions = companion_files(path);
  if (companions.empty()) return hash;
  for (const fs::path& file : companions) {
    TRY_ASSIGN(const std::string of_companion, hash_file(file.string()));
    hash += " " + of_companion;
  }
  return hash_bytes(hash);
}

}  // namespace retarget
