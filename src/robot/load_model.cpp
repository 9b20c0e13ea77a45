#include "robot/load_model.h"

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "retarget/base/file.h"

namespace retarget {
namespace {

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};

// MuJoCo reports through global handlers and keeps the last XML in a global: one load at a time
std::mutex load_mutex;
std::string first_error;  // guarded by load_mutex

// takes MuJoCo's messages while it lives; the defaults print, write a log file and end the process
class MessageGuard {
 public:
  MessageGuard() : old_error_(mju_user_error), old_warning_(mju_user_warning) {
    first_error.clear();
    mju_user_error = [](const char* text) {
      if (first_error.empty()) first_error = text;
    };
    mju_user_warning = [](const char*) {};
  }
  ~MessageGuard() {
    mju_user_error = old_error_;
    mju_user_warning = old_warning_;
  }
  MessageGuard(const MessageGuard&) = delete;
  MessageGuard& operator=(const MessageGuard&) = delete;

 private:
  void (*old_error_)(const char*);
  void (*old_warning_)(const char*);
};

template <typename Predicate>
void delete_elements(mjSpec* spec, mjtObj kind, Predicate unwanted) {
  std::vector<mjsElement*> doomed;
  for (mjsElement* e = mjs_firstElement(spec, kind); e != nullptr; e = mjs_nextElement(spec, e)) {
    if (unwanted(e)) doomed.push_back(e);
  }
  for (mjsElement* element : doomed) mjs_delete(spec, element);
}

bool is_named(const mjString* text) {
  return *mjs_getString(text) != '\0';
}

// what is left moves the same way and needs no file beside the MJCF
void keep_kinematics(mjSpec* spec) {
  delete_elements(spec, mjOBJ_GEOM, [](mjsElement* element) {
    const mjsGeom* geom = mjs_asGeom(element);
    return is_named(geom->meshname) || is_named(geom->hfieldname) || geom->type == mjGEOM_MESH ||
           geom->type == mjGEOM_HFIELD || geom->type == mjGEOM_SDF;
  });
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_GEOM); e != nullptr;
       e = mjs_nextElement(spec, e)) {
    mjs_setString(mjs_asGeom(e)->material, "");
  }
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_SITE); e != nullptr;
       e = mjs_nextElement(spec, e)) {
    mjs_setString(mjs_asSite(e)->material, "");
  }
  constexpr std::array kDropped = {mjOBJ_SENSOR,   mjOBJ_ACTUATOR, mjOBJ_TENDON,  mjOBJ_EQUALITY,
                                   mjOBJ_KEY,      mjOBJ_PAIR,     mjOBJ_EXCLUDE, mjOBJ_SKIN,
                                   mjOBJ_FLEX,     mjOBJ_TUPLE,    mjOBJ_MESH,    mjOBJ_HFIELD,
                                   mjOBJ_MATERIAL, mjOBJ_TEXTURE};
  for (const mjtObj kind : kDropped) {
    delete_elements(spec, kind, [](mjsElement*) { return true; });
  }
  // bodies whose mass came from a mesh are left without any
  spec->compiler.boundmass = 1e-6;
  spec->compiler.boundinertia = 1e-9;
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;)
    text.replace(at, 1, "; ");
  return text;
}

// "..., line 12, column 3" at the end of MuJoCo's XML errors becomes the error's place
Failure model_failure(const std::string& path, const std::string& text) {
  Error error;
  error.kind = ErrorKind::kConfig;
  error.file = path;
  error.message = "MuJoCo cannot load the model: " + one_line(text);
  const auto number_after = [&](const std::string& word) -> std::size_t {
    const std::size_t at = text.rfind(word);
    return at == std::string::npos ? 0 : std::strtoul(text.c_str() + at + word.size(), nullptr, 10);
  };
  error.line = number_after("line ");
  if (error.line > 0) error.column = number_after("column ");
  return failure(std::move(error));
}

Result<void> check_joints(const mjModel& model, const std::string& path) {
  int free_joints = 0;
  for (int j = 0; j < model.njnt; ++j) {
    const char* name = mj_id2name(&model, mjOBJ_JOINT, j);
    if (model.jnt_type[j] == mjJNT_FREE) ++free_joints;
    if (model.jnt_type[j] == mjJNT_BALL) {
      return config_failure(path,
                            "the ball joint \"" + std::string(name ? name : "") +
                                "\" is not supported: joints must be hinges or slides",
                            "write it as three hinges");
    }
  }
  if (free_joints == 0) {
    return config_failure(path, "the model has no free joint: its base cannot move",
                          "add <freejoint/> to the root body");
  }
  if (free_joints > 1) {
    return config_failure(path, "the model has " + std::to_string(free_joints) +
                                    " free joints: one robot at a time, without loose objects");
  }
  if (model.jnt_type[0] != mjJNT_FREE) {
    return config_failure(path, "the free joint must be the model's first joint");
  }
  return {};
}

}  // namespace

Result<mjModel*> load_model(const std::string& path) {
  // MuJoCo's own words for a file that is not there are less clear
  if (const auto readable = read_file(path, ErrorKind::kConfig); !readable) {
    return failure(readable.error());
  }
  const std::lock_guard lock(load_mutex);
  const MessageGuard guard;
  std::array<char, 2000> text{};
  const std::unique_ptr<mjSpec, SpecDeleter> spec(
      mj_parseXML(path.c_str(), nullptr, text.data(), text.size()));
  if (!spec) return model_failure(path, text.data());
  keep_kinematics(spec.get());
  std::unique_ptr<mjModel, ModelDeleter> model(mj_compile(spec.get(), nullptr));
  if (!model) return model_failure(path, mjs_getError(spec.get()));
  if (!first_error.empty()) return model_failure(path, first_error);
  if (auto checked = check_joints(*model, path); !checked) return failure(checked.error());
  return model.release();
}

}  // namespace retarget
