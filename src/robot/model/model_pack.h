#pragma once

#include <mujoco/mujoco.h>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "retarget/error.h"
#include "robot/model/load_model.h"

namespace retarget {

// Packs: compiled models of one robot in a file that is read without MuJoCo, for the browser
// (docs/browser.md). A pack holds the arrays of mjModel that the library reads after loading, and
// the other results of load_model.

// Arrays of a model: X(type, name, elements, numbers per element).
#define RETARGET_PACKED_ARRAYS(X)       \
  X(double, qpos0, nq, 1)               \
  X(int, body_parentid, nbody, 1)       \
  X(int, body_rootid, nbody, 1)         \
  X(int, body_weldid, nbody, 1)         \
  X(int, body_jntnum, nbody, 1)         \
  X(int, body_jntadr, nbody, 1)         \
  X(int, body_geomnum, nbody, 1)        \
  X(int, body_geomadr, nbody, 1)        \
  X(double, body_pos, nbody, 3)         \
  X(double, body_quat, nbody, 4)        \
  X(double, body_ipos, nbody, 3)        \
  X(double, body_iquat, nbody, 4)       \
  X(double, body_mass, nbody, 1)        \
  X(double, body_subtreemass, nbody, 1) \
  X(double, body_inertia, nbody, 3)     \
  X(int, jnt_type, njnt, 1)             \
  X(int, jnt_qposadr, njnt, 1)          \
  X(int, jnt_dofadr, njnt, 1)           \
  X(int, jnt_bodyid, njnt, 1)           \
  X(bool, jnt_limited, njnt, 1)         \
  X(bool, jnt_actfrclimited, njnt, 1)   \
  X(double, jnt_pos, njnt, 3)           \
  X(double, jnt_axis, njnt, 3)          \
  X(double, jnt_range, njnt, 2)         \
  X(double, jnt_actfrcrange, njnt, 2)   \
  X(double, dof_armature, nv, 1)        \
  X(int, geom_type, ngeom, 1)           \
  X(int, geom_contype, ngeom, 1)        \
  X(int, geom_conaffinity, ngeom, 1)    \
  X(int, geom_bodyid, ngeom, 1)         \
  X(int, geom_dataid, ngeom, 1)         \
  X(double, geom_size, ngeom, 3)        \
  X(double, geom_aabb, ngeom, 6)        \
  X(double, geom_pos, ngeom, 3)         \
  X(double, geom_quat, ngeom, 4)        \
  X(int, name_bodyadr, nbody, 1)        \
  X(int, name_jntadr, njnt, 1)          \
  X(int, name_geomadr, ngeom, 1)        \
  X(char, names, nnames, 1)

/// The arrays of one model and their sizes. std::vector<bool> has no data(), so flags are bytes.
struct PackedArrays {
  template <typename T>
  using Array = std::vector<std::conditional_t<std::is_same_v<T, bool>, char, T>>;

  std::int64_t nq = 0, nv = 0, nbody = 0, njnt = 0, ngeom = 0, nnames = 0;
#define RETARGET_MEMBER(type, name, elements, numbers) Array<type> name;
  RETARGET_PACKED_ARRAYS(RETARGET_MEMBER)
#undef RETARGET_MEMBER
};

struct PackedModel : PackedArrays {
  std::string file;    ///< Name of the model's file, without folder.
  LoadedModel loaded;  ///< Robot without its model.
};

/// Reads a pack. Checks every count, index and name, so that the arrays are safe to use: counts
/// against the remaining bytes, indices against the sizes of their arrays, and names for their
/// terminating zero. Errors: kConfig.
[[nodiscard]] Result<std::vector<PackedModel>> parse_model_pack(std::string_view bytes,
                                                                const std::string& file);

/// Name of a robot's pack, in its folder.
inline constexpr std::string_view kModelPackName = "models.pack";

}  // namespace retarget
