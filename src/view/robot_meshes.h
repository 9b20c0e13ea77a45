#pragma once

#include <string>
#include <vector>

#include "retarget/robot.h"
#include "view/triangle_mesh.h"

namespace retarget {

/// What a body looks like.
struct BodyMesh {
  int body = 0;
  TriangleMesh mesh;  ///< In the body's frame.
};

/// The meshes of a folder that are named like bodies of a robot, in whatever case: `left_knee_link.STL`
/// for the body left_knee_link; also `left_knee.obj`, and, where there is no other,
/// `left_knee_link_rev_2.stl`. Simplified, so that a page stays small.
/// Errors: of kUsage, no such folder; of kInput, a mesh that cannot be read, none that fits.
[[nodiscard]] Result<std::vector<BodyMesh>> load_body_meshes(const Robot& robot,
                                                             const std::string& folder);

}  // namespace retarget
