#pragma once

#include <memory>
#include <span>
#include <utility>

#include "retarget/robot.h"

struct mjData_;

namespace retarget {

/// MuJoCo's own contacts between the geoms of a robot.
///
/// MuJoCo's depth of a contact with a box is not always the least way out: it looks for the deepest
/// of a few points. Who judges with MuJoCo gets these depths, so they are reported beside the exact
/// ones.
class MujocoContacts {
 public:
  explicit MujocoContacts(std::shared_ptr<const Robot> robot);
  ~MujocoContacts();
  MujocoContacts(const MujocoContacts&) = delete;
  MujocoContacts& operator=(const MujocoContacts&) = delete;

  /// Depth of the deepest contact between one of these pairs of geoms, metres; 0 without.
  [[nodiscard]] double depth(std::span<const double> qpos,
                             std::span<const std::pair<int, int>> geoms);

 private:
  std::shared_ptr<const Robot> robot_;
  mjData_* data_ = nullptr;  // made when it is needed
};

}  // namespace retarget
