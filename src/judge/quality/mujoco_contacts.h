#pragma once

#include <memory>
#include <span>
#include <utility>

#include "retarget/robot.h"

struct mjData_;

namespace retarget {

/// Computes MuJoCo's contacts between the geoms of a robot.
///
/// For a contact with a box, MuJoCo's depth is not always the shortest translation that separates
/// the shapes, because MuJoCo searches only a few points for the deepest one. Reports contain these
/// depths in addition to the exact ones, for comparison with evaluations in MuJoCo.
class MujocoContacts {
 public:
  explicit MujocoContacts(std::shared_ptr<const Robot> robot);
  ~MujocoContacts();
  MujocoContacts(const MujocoContacts&) = delete;
  MujocoContacts& operator=(const MujocoContacts&) = delete;

  /// Depth of the deepest contact between the given pairs of geoms, metres; 0 without contact.
  [[nodiscard]] double depth(std::span<const double> qpos,
                             std::span<const std::pair<int, int>> geoms);

 private:
  std::shared_ptr<const Robot> robot_;
  mjData_* data_ = nullptr;  // Allocated on demand.
};

}  // namespace retarget
