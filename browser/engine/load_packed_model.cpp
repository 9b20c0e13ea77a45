// load_model without MuJoCo: models come from the pack in the robot's folder, and these are the
// functions of MuJoCo that the library calls on a model.

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/load_model.h"
#include "robot/model/model_pack.h"

namespace {

// A model whose arrays it owns.
struct OwnedModel : mjModel_ {
  explicit OwnedModel(retarget::PackedArrays packed) : mjModel_(), arrays(std::move(packed)) {
    nq = arrays.nq;
    nv = arrays.nv;
    nbody = arrays.nbody;
    njnt = arrays.njnt;
    ngeom = arrays.ngeom;
    nnames = arrays.nnames;
#define RETARGET_POINT(type, name, elements, numbers) \
  this->name = reinterpret_cast<type*>(arrays.name.data());
    RETARGET_PACKED_ARRAYS(RETARGET_POINT)
#undef RETARGET_POINT
  }

  retarget::PackedArrays arrays;
};

const OwnedModel& owned(const mjModel* model) {
  return *static_cast<const OwnedModel*>(model);
}

const std::vector<int>* name_addresses(const mjModel* model, int type) {
  switch (type) {
    case mjOBJ_BODY:
      return &owned(model).arrays.name_bodyadr;
    case mjOBJ_JOINT:
      return &owned(model).arrays.name_jntadr;
    case mjOBJ_GEOM:
      return &owned(model).arrays.name_geomadr;
    default:
      return nullptr;
  }
}

}  // namespace

extern "C" {

void mj_deleteModel(mjModel* model) {
  delete static_cast<OwnedModel*>(model);
}

mjModel* mj_copyModel(mjModel* /*destination*/, const mjModel* source) {
  return std::make_unique<OwnedModel>(owned(source).arrays).release();
}

const char* mj_id2name(const mjModel* model, int type, int id) {
  const std::vector<int>* addresses = name_addresses(model, type);
  if (addresses == nullptr || id < 0 || id >= static_cast<int>(addresses->size())) return nullptr;
  const char* name = model->names + (*addresses)[static_cast<std::size_t>(id)];
  return *name == '\0' ? nullptr : name;
}

int mj_name2id(const mjModel* model, int type, const char* name) {
  const std::vector<int>* addresses = name_addresses(model, type);
  if (addresses == nullptr) return -1;
  const auto found = std::ranges::find_if(
      *addresses, [&](int address) { return std::strcmp(model->names + address, name) == 0; });
  return found == addresses->end() ? -1 : static_cast<int>(found - addresses->begin());
}

int mj_version() {
  return mjVERSION_HEADER;
}

}  // extern "C"

namespace retarget {

Result<LoadedModel> load_model(const std::string& path, const ModelChanges& changes) {
  const std::filesystem::path file(path);
  const std::string pack = (file.parent_path() / kModelPackName).string();
  if (!is_file(pack)) {
    return config_failure(path, "models cannot be read in the browser",
                          "choose one of the robots of the page");
  }
  TRY_ASSIGN(const auto bytes, read_file(pack, ErrorKind::kConfig));
  TRY_ASSIGN(auto models, parse_model_pack(bytes.view(), pack));
  const auto found = std::ranges::find_if(
      models, [&](const PackedModel& model) { return model.file == file.filename(); });
  const bool plain =
      !changes.name_all && !changes.keep_meshes && !changes.find_meshes && !changes.keep_heights;
  if (found == models.end() || !plain) {
    return config_failure(path, "the pack of the robot does not have this model");
  }
  LoadedModel loaded = std::move(found->loaded);
  for (std::vector<char>* flags : {&found->jnt_limited, &found->jnt_actfrclimited}) {
    for (char& flag : *flags) flag = flag != 0 ? 1 : 0;
  }
  loaded.model = ModelPtr(std::make_unique<OwnedModel>(std::move(*found)).release());
  return loaded;
}

Result<void> check_robot_joints(const mjModel_& model, const std::string& path) {
  // The tool that made the pack has checked its models; this keeps a damaged one from the solvers.
  const int* types = model.jnt_type;
  const bool right = model.njnt > 0 && types[0] == mjJNT_FREE &&
                     std::all_of(types + 1, types + model.njnt, [](int type) {
                       return type == mjJNT_HINGE || type == mjJNT_SLIDE;
                     });
  if (right) return {};
  return config_failure(path, "the model is not a robot with one free joint");
}

}  // namespace retarget
