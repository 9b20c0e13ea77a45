#pragma once

#include <mujoco/mujoco.h>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <string>

#include "retarget/pose.h"

namespace retarget {

/// Returns the vector of one element in a flat MuJoCo array.
[[nodiscard]] inline Eigen::Vector3d vector_at(const double* values, int element) {
  return Eigen::Map<const Eigen::Vector3d>(values + 3 * static_cast<std::ptrdiff_t>(element));
}

/// Returns the pose of one element in MuJoCo's arrays of positions and quaternions (wxyz).
[[nodiscard]] inline Pose pose_at(const double* positions, const double* quaternions, int element) {
  const double* q = quaternions + 4 * static_cast<std::ptrdiff_t>(element);
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(), vector_at(positions, element)};
}

/// Returns the name of an element; empty without one.
[[nodiscard]] inline std::string name_in_model(const mjModel& model, mjtObj kind, int index) {
  const char* name = mj_id2name(&model, kind, index);
  return name == nullptr ? std::string() : std::string(name);
}

struct MujocoSpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using MujocoSpec = std::unique_ptr<mjSpec, MujocoSpecDeleter>;

struct MujocoDataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoData = std::unique_ptr<mjData, MujocoDataDeleter>;

}  // namespace retarget
