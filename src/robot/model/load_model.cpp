#include "robot/model/load_model.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <string_view>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/check_model.h"
#include "robot/model/model_values.h"
#include "robot/model/mujoco_messages.h"
#include "robot/model/repair_model.h"
#include "robot/model/urdf_extras.h"
#include "version_numbers.h"

namespace retarget {
namespace {

bool is_named(const mjString* text) {
  return *mjs_getString(text) != '\0';
}

// Whether a height field needs no file.
bool is_inline_height_field(mjSpec* spec, const mjsGeom& geom) {
  mjsElement* field = mjs_findElement(spec, mjOBJ_HFIELD, mjs_getString(geom.hfieldname));
  return geom.type == mjGEOM_HFIELD && field != nullptr && !is_named(mjs_asHField(field)->file);
}

// Deletes the geoms that need files. @return bodies that lose a geom with contacts, by name
std::vector<std::string> drop_geoms(mjSpec* spec, const ModelChanges& changes) {
  std::vector<std::string> bodies;
  for (mjsElement* element : elements_of(spec, mjOBJ_GEOM)) {
    const mjsGeom* geom = mjs_asGeom(element);
    mjs_setString(geom->material, "");
    if (changes.keep_meshes && geom->type == mjGEOM_MESH) continue;
    if (changes.keep_heights && is_inline_height_field(spec, *geom)) continue;
    if (is_named(geom->meshname) || is_named(geom->hfieldname) || geom->type == mjGEOM_MESH ||
        geom->type == mjGEOM_HFIELD || geom->type == mjGEOM_SDF) {
      if (geom->contype != 0 || geom->conaffinity != 0) {
        bodies.emplace_back(mjs_getString(mjs_getName(mjs_getParent(element)->element)));
      }
      mjs_delete(spec, element);
    }
  }
  return bodies;
}

// The remaining elements have the same kinematics and need no files other than the MJCF.
void keep_kinematics(mjSpec* spec, const ModelChanges& changes) {
  for (mjsElement* e : elements_of(spec, mjOBJ_SITE)) mjs_setString(mjs_asSite(e)->material, "");
  constexpr std::array kDropped = {mjOBJ_SENSOR,   mjOBJ_ACTUATOR, mjOBJ_TENDON,  mjOBJ_EQUALITY,
                                   mjOBJ_KEY,      mjOBJ_PAIR,     mjOBJ_EXCLUDE, mjOBJ_SKIN,
                                   mjOBJ_FLEX,     mjOBJ_TUPLE,    mjOBJ_MESH,    mjOBJ_HFIELD,
                                   mjOBJ_MATERIAL, mjOBJ_TEXTURE};
  for (const mjtObj kind : kDropped) {
    if (changes.keep_meshes && kind == mjOBJ_MESH) continue;
    for (mjsElement* element : elements_of(spec, kind)) {
      const bool kept =
          kind == mjOBJ_HFIELD && changes.keep_heights && !is_named(mjs_asHField(element)->file);
      if (!kept) mjs_delete(spec, element);
    }
  }
  // Retargeting configurations may name bodies that are fixed to their parent.
  spec->compiler.fusestatic = 0;
  // Bodies whose mass came from a mesh now have none; wrong inertias do not affect kinematics.
  spec->compiler.boundmass = 1e-6;
  spec->compiler.boundinertia = 1e-9;
  spec->compiler.balanceinertia = 1;
}

bool has_free_joint(mjSpec* spec) {
  return std::ranges::any_of(elements_of(spec, mjOBJ_JOINT),
                             [](mjsElement* e) { return mjs_asJoint(e)->type == mjJNT_FREE; });
}

// A base with its own joints is left unchanged.
void float_base(mjSpec* spec, LoadedModel& loaded) {
  if (has_free_joint(spec)) return;
  loaded.sliding = free_sliding_root(spec);
  mjsBody* base = robot_base(spec);
  if (base == nullptr || mjs_firstChild(base, mjOBJ_JOINT, 0) != nullptr) return;
  mjs_addFreeJoint(base);
  const std::string name = mjs_getString(mjs_getName(base->element));
  loaded.floated_body = name.empty() ? "the topmost body" : name;
}

// Names unnamed elements with the word for their kind and a number.
void name_elements(mjSpec* spec, mjtObj kind, const std::string& word) {
  int number = 0;
  for (mjsElement* e : elements_of(spec, kind)) {
    if (is_named(mjs_getName(e))) continue;
    std::string name;
    do {
      name = word + "_" + std::to_string(++number);
    } while (mjs_findElement(spec, kind, name.c_str()) != nullptr);
    mjs_setName(e, name.c_str());
  }
}

// Records the joint couplings given by equality constraints.
void note_couplings(mjSpec* spec, LoadedModel& loaded) {
  for (mjsElement* e : elements_of(spec, mjOBJ_EQUALITY)) {
    const mjsEquality* equality = mjs_asEquality(e);
    const std::string first = mjs_getString(equality->name1);
    const std::string second = mjs_getString(equality->name2);
    // y - y0 = a0 + a1 (x - x0) + ...; add_references adds the reference positions x0 and y0.
    if (equality->type != mjEQ_JOINT || second.empty()) continue;
    loaded.couplings[first] = {second, equality->data[1], equality->data[0]};
  }
}

// MuJoCo measures coupled joint positions from the joints' reference positions.
void add_references(const mjModel& model, std::map<std::string, JointCoupling>& couplings) {
  const auto reference = [&](const std::string& name) {
    const int joint = mj_name2id(&model, mjOBJ_JOINT, name.c_str());
    return joint < 0 ? 0.0 : model.qpos0[model.jnt_qposadr[joint]];
  };
  for (auto& [name, coupling] : couplings) {
    coupling.offset += reference(name) - coupling.ratio * reference(coupling.leader);
  }
}

// Compiles the model, with changed masses and inertias if MuJoCo rejects those given.
// @param repaired  the bodies with changed masses or inertias, by name
ModelPtr compile(mjSpec* spec, const MessageGuard& guard, std::vector<std::string>& repaired,
                 std::size_t& errors) {
  repaired = repair_negative_inertials(spec);
  ModelPtr model(mj_compile(spec, nullptr));
  if (model) return model;
  const std::string said = mjs_getError(spec);
  if (said.find("inertia") == std::string::npos && said.find("mass") == std::string::npos) {
    return model;
  }
  const std::vector<std::string> degenerate = repair_degenerate_inertias(spec);
  if (degenerate.empty()) return model;
  repaired.insert(repaired.end(), degenerate.begin(), degenerate.end());
  errors = guard.errors().size();
  model.reset(mj_compile(spec, nullptr));
  return model;
}

// MuJoCo's own messages for a missing file or a file that is not XML are less clear.
Result<void> check_file(const std::string& path) {
  if (path == "-") return config_failure("", "a model cannot come from standard input");
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  // Reading a pipe would consume it here, and MuJoCo would then wait forever.
  if (std::filesystem::is_other(status)) {
    return config_failure(path, "a model must be a regular file");
  }
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig));
  std::string_view rest = without_byte_order_mark(text.view());
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  if (rest.empty()) return config_failure(path, "the file is empty: expected an MJCF model");
  if (!rest.starts_with('<')) {
    return config_failure(path, "the file is not XML: expected an MJCF model");
  }
  return {};
}

// The layout of mjModel differs between MuJoCo versions.
Result<void> check_version() {
  if (mj_version() == mjVERSION_HEADER) return {};
  const std::string built_with = mujoco_version_text(mjVERSION_HEADER);
  return run_failure("",
                     "built with MuJoCo " + built_with + ", but the loaded library is " +
                         mujoco_version_text(mj_version()),
                     "make the program find MuJoCo " + built_with + ", or rebuild it");
}

std::string quoted_name(const mjModel& model, mjtObj kind, int index) {
  return "\"" + name_in_model(model, kind, index) + "\"";
}

bool all_finite(const mjtNum* values, int count) {
  return std::all_of(values, values + count, [](mjtNum v) { return std::isfinite(v); });
}

// Whether the bounds of a range are numbers: finite ones, or any if the range does not limit.
bool has_numbers(const mjtNum* range, bool limits) {
  return limits ? all_finite(range, 2) : !std::isnan(range[0]) && !std::isnan(range[1]);
}

Result<void> check_numbers(const mjModel& model, const std::string& path) {
  const std::string not_finite = " has a number that is not finite";
  for (int b = 0; b < model.nbody; ++b) {
    const bool placed =
        all_finite(model.body_pos + 3 * b, 3) && all_finite(model.body_quat + 4 * b, 4);
    // The inertial may come from geoms.
    const bool weighed = std::isfinite(model.body_mass[b]) &&
                         all_finite(model.body_inertia + 3 * b, 3) &&
                         all_finite(model.body_ipos + 3 * b, 3);
    if (!placed || !weighed) {
      return config_failure(path, "the body " + quoted_name(model, mjOBJ_BODY, b) + not_finite);
    }
  }
  for (int j = 0; j < model.njnt; ++j) {
    const bool finite = all_finite(model.jnt_pos + 3 * j, 3) &&
                        all_finite(model.jnt_axis + 3 * j, 3) &&
                        has_numbers(model.jnt_range + 2 * j, model.jnt_limited[j] != 0) &&
                        std::isfinite(model.qpos0[model.jnt_qposadr[j]]);
    if (!finite) {
      return config_failure(path, "the joint " + quoted_name(model, mjOBJ_JOINT, j) + not_finite);
    }
    // MuJoCo treats such a joint as unlimited.
    if (model.jnt_range[2 * j] > model.jnt_range[2 * j + 1]) {
      return config_failure(path, "the joint " + quoted_name(model, mjOBJ_JOINT, j) +
                                      " has a range with lower above upper");
    }
  }
  for (int g = 0; g < model.ngeom; ++g) {
    if (!all_finite(model.geom_pos + 3 * g, 3) || !all_finite(model.geom_quat + 4 * g, 4) ||
        !all_finite(model.geom_size + 3 * g, 3)) {
      const int body = model.geom_bodyid[g];
      return config_failure(
          path, "a geom of the body " + quoted_name(model, mjOBJ_BODY, body) + not_finite);
    }
  }
  return {};
}

using MessageBuffer = std::array<char, 2000>;

// Reads a changed text of the file at `path`, whose assets are relative to its folder.
MujocoSpec parse_text(const std::string& text, const std::string& path, MessageBuffer& error) {
  MujocoSpec spec(
      mj_parseXMLString(text.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  const std::string folder = std::filesystem::path(path).parent_path().string();
  if (spec) mjs_setString(spec->modelfiledir, folder.c_str());
  return spec;
}

// MuJoCo's error for a model that it read but does not compile; empty: none.
std::string later_complaint(mjSpec* spec) {
  const mjsBody* world = mjs_findBody(spec, "world");
  for (mjsElement* element : elements_of(spec, mjOBJ_JOINT)) {
    if (mjs_asJoint(element)->type != mjJNT_FREE) continue;
    const mjsBody* body = mjs_getParent(element);
    if (body != nullptr && mjs_getParent(body->element) != world) return kNestedFreeJoint;
  }
  return {};
}

// Reads the XML. MuJoCo rejects several materials of one visual, which other readers of URDF
// accept, and unknown parts that do not affect kinematics; those are removed, with a warning.
// @param finds_base  omit links of a URDF above the robot's base.
Result<MujocoSpec> parse_model(const std::string& path, bool finds_base,
                               std::vector<std::string>& warnings) {
  MessageBuffer error{};
  MujocoSpec spec(mj_parseXML(path.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!spec && std::string_view(error.data()).find("repeated element: 'material'") !=
                   std::string_view::npos) {
    TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig));
    spec = parse_text(without_materials(std::string(text.view())), path, error);
  }
  const std::string first_error = spec ? std::string() : error.data();
  std::string complaint = spec ? later_complaint(spec.get()) : first_error;
  ModelRepair repair(path);
  constexpr int kMaxRepairs = 10;
  for (int i = 0; i < kMaxRepairs && !complaint.empty(); ++i) {
    const auto text = repair.repair(complaint);
    if (!text) break;
    if (MujocoSpec repaired = parse_text(*text, path, error)) {
      complaint = later_complaint(repaired.get());
      spec = std::move(repaired);
    } else {
      complaint = error.data();
    }
  }
  if (!spec) return model_failure(path, first_error);
  if (const auto text = finds_base ? repair.drop_links_above_base() : std::nullopt) {
    if (MujocoSpec based = parse_text(*text, path, error)) spec = std::move(based);
  }
  warnings.insert(warnings.end(), repair.notes().begin(), repair.notes().end());
  if (const auto names = xacro_leftovers(path); !names.empty()) {
    warnings.push_back("elements of xacro without a definition are ignored: " +
                       list_names(names, 4));
  }
  return spec;
}

}  // namespace

Result<LoadedModel> load_model(const std::string& path, const ModelChanges& changes) {
  TRY(check_version());
  TRY(check_file(path));
  TRY(check_model(path, changes.keep_meshes || changes.find_meshes));

  const std::lock_guard lock(mujoco_mutex());
  const MessageGuard guard;
  LoadedModel loaded;
  TRY_ASSIGN(const MujocoSpec spec, parse_model(path, changes.float_base, loaded.warnings));
  for (mjsElement* e : elements_of(spec.get(), mjOBJ_EXCLUDE)) {
    const mjsExclude* exclude = mjs_asExclude(e);
    loaded.excluded.emplace_back(mjs_getString(exclude->bodyname1),
                                 mjs_getString(exclude->bodyname2));
  }
  if (changes.name_all) {
    name_elements(spec.get(), mjOBJ_BODY, "body");
    name_elements(spec.get(), mjOBJ_JOINT, "joint");
  }
  loaded.tied = tied_bodies(spec.get());
  note_couplings(spec.get(), loaded);
  MeshGeoms mesh_geoms;
  if (changes.find_meshes) mesh_geoms.replace(spec.get());
  loaded.dropped = drop_geoms(spec.get(), changes);
  keep_kinematics(spec.get(), changes);
  if (changes.float_base) {
    loaded.held = hold_loose_balls(spec.get());
    float_base(spec.get(), loaded);
  }
  if (const auto body = body_with_infinite_inertial(spec.get())) {
    return config_failure(
        path, "the mass or inertia of the body \"" + *body + "\" has a number that is not finite");
  }
  std::size_t errors = 0;  // Number of errors that were repaired.
  std::vector<std::string> repaired;
  loaded.model = compile(spec.get(), guard, repaired, errors);
  if (!loaded.model) return model_failure(path, mjs_getError(spec.get()));
  if (guard.errors().size() > errors) return model_failure(path, guard.errors()[errors]);
  TRY(check_numbers(*loaded.model, path));
  UrdfFacts urdf = urdf_facts(path);
  const auto locked = lock_single_positions(spec.get(), *loaded.model, urdf.is_urdf);
  const auto notes = notes_about_inertials(spec.get(), *loaded.model, repaired);
  loaded.warnings.insert(loaded.warnings.end(), notes.begin(), notes.end());
  add_references(*loaded.model, loaded.couplings);
  // MuJoCo ignores <mimic> elements.
  for (auto& [name, coupling] : urdf.couplings) loaded.couplings[name] = std::move(coupling);
  loaded.meshes = mesh_geoms.find(*loaded.model);
  loaded.warnings.insert(loaded.warnings.end(), guard.warnings().begin(), guard.warnings().end());
  // MuJoCo versions report a warning here, through the handler, or both.
  const std::string warning =
      mjs_isWarning(spec.get()) != 0 ? one_line(mjs_getError(spec.get())) : std::string();
  if (!warning.empty() && std::ranges::find(loaded.warnings, warning) == loaded.warnings.end()) {
    loaded.warnings.push_back(warning);
  }
  for (const std::string& joint : locked) {
    std::erase(loaded.warnings,
               "joint '" + joint + "' has equal lower and upper limits, limit ignored");
  }
  return loaded;
}

Result<void> check_robot_joints(const mjModel_& model, const std::string& path) {
  const int* types = model.jnt_type;
  const auto free_joints = std::count(types, types + model.njnt, mjJNT_FREE);
  if (free_joints == 0) {
    return config_failure(
        path, "the model has no free joint: its base cannot move",
        urdf_facts(path).is_urdf
            ? "convert the URDF to MJCF and add <freejoint/> to the root body; for a fixed base, "
              "use " OPTION("base") " fixed"
            : "add <freejoint/> to the root body; for a fixed base, use " OPTION("base") " fixed");
  }
  if (free_joints > 1) {
    return config_failure(path, "the model has " + std::to_string(free_joints) +
                                    " free joints: expected one robot without loose objects");
  }
  if (types[0] != mjJNT_FREE) {
    return config_failure(path,
                          "the free joint must be the model's first joint, found " +
                              quoted_name(model, mjOBJ_JOINT, 0) + " before it",
                          "move the robot to the top of <worldbody>");
  }
  // body_rootid is the topmost body of the tree below the world.
  const int tree = model.body_rootid[model.jnt_bodyid[0]];
  for (int j = 0; j < model.njnt; ++j) {
    if (types[j] == mjJNT_BALL) {
      return config_failure(path,
                            "the ball joint " + quoted_name(model, mjOBJ_JOINT, j) +
                                " is not supported: joints must be hinges or slides",
                            "write it as three hinges");
    }
    if (model.body_rootid[model.jnt_bodyid[j]] != tree) {
      return config_failure(path, "the joint " + quoted_name(model, mjOBJ_JOINT, j) +
                                      " is not below the body with the free joint: expected one "
                                      "robot without other moving bodies");
    }
  }
  return {};
}

}  // namespace retarget
