#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>
#include <vector>

namespace retarget {

/// MuJoCo accepts a free joint only at the top of the tree; a compiler finds the joint later.
inline constexpr const char* kNestedFreeJoint = "free joint can only be used on top level";

/// Repairs the XML of a model that MuJoCo rejects for a reason other than its kinematics: sensors
/// and actuators that MuJoCo does not know, and bodies that represent the world.
///
/// The XML is that of the model with its included files, so lines of errors are not those of the
/// file.
class ModelRepair {
 public:
  /// @param path  a model that check_model has accepted.
  explicit ModelRepair(std::string path) : path_(std::move(path)) {}

  /// Removes what MuJoCo complains about, or what may contain it.
  /// @return the changed XML; nothing if the complaint concerns kinematics.
  [[nodiscard]] std::optional<std::string> mend(const std::string& complaint);

  /// The removed parts, one sentence each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  bool load();
  bool apply(const std::string& complaint);
  bool drop_attribute(const std::string& complaint);
  bool drop_sections(const std::string& complaint);
  bool free_world_bodies();
  bool free_world_links();

  std::string path_;
  tinyxml2::XMLDocument document_;
  bool dropped_sections_ = false;
  std::vector<std::string> notes_;
};

}  // namespace retarget
