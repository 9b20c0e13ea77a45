#include "retarget/scene.h"

namespace retarget {

int Scene::find(const std::string& body) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace retarget
