#pragma once

#include <tinyxml2.h>
#include <map>
#include <string>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Whether a model is a URDF, whatever its extension: by the name of its root element, as MuJoCo.
[[nodiscard]] bool is_urdf(const tinyxml2::XMLElement& root);

/// Facts about a model file that MuJoCo's reader drops.
struct UrdfFacts {
  bool is_urdf = false;
  /// By joint: `<mimic joint= multiplier= offset=>`.
  std::map<std::string, JointCoupling> couplings;
  /// By joint: `<limit velocity=>` above 0, rad/s or m/s.
  std::map<std::string, double> speeds;
};
/// Reads the facts. A file that cannot be read has none.
[[nodiscard]] UrdfFacts urdf_facts(const std::string& path);

/// Whether an element of a URDF belongs to a simulator or a controller; MuJoCo ignores it.
[[nodiscard]] bool is_extension_of_urdf(const tinyxml2::XMLElement& element);

/// Whether an element belongs to xacro.
[[nodiscard]] bool is_xacro(const tinyxml2::XMLElement& element);

/// Whether a URDF needs xacro: it defines or includes macros, or has links or joints in xacro
/// elements.
[[nodiscard]] bool is_xacro_template(const tinyxml2::XMLElement& root);

/// Returns the names of xacro elements in an expanded file (not a template), each once. Nothing
/// defines them, so an expansion left them behind; MuJoCo ignores them in a URDF.
[[nodiscard]] std::vector<std::string> xacro_leftovers(const std::string& path);

/// Replaces the materials of a URDF by spaces, so that positions in the text stay the same. They
/// have no effect on kinematics.
[[nodiscard]] std::string without_materials(std::string text);

}  // namespace retarget
