// Any bytes as a mesh of a page, STL, OBJ and COLLADA, read and simplified.

#include <string_view>

#include "fuzz/fuzz_target.h"
#include "robot/model/read_mesh.h"
#include "robot/model/robot_meshes.h"

namespace retarget::fuzz {
namespace {

void check_mesh(const TriangleMesh& mesh) {
  const auto count = static_cast<int>(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle)
      require(corner >= 0 && corner < count, "corners are vertices");
  }
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    require(vertex.cwiseAbs().maxCoeff() <= 10.0 + 1e-9, "vertices are near");
  }
}

}  // namespace

void fuzz_mesh(std::string_view bytes) {
  constexpr std::size_t kMost = 20;
  for (const char* name : {"fuzz.stl", "fuzz.obj", "fuzz.dae"}) {
    const auto mesh = read_mesh(bytes, name);
    if (!good(mesh)) continue;
    require(!mesh->triangles.empty(), "meshes have triangles");
    check_mesh(*mesh);
    const TriangleMesh simple = simplified(*mesh, kMost);
    require(simple.triangles.size() <= kMost, "simplified is what it says");
    check_mesh(simple);
  }
}

}  // namespace retarget::fuzz
