#include "retarget/restore_motion.h"

#include "app/plan/surroundings.h"

namespace retarget {

Result<std::shared_ptr<const SceneWorld>> restore_human_scene(const Plan& plan,
                                                              const Clip& prepared) {
  return human_surroundings(plan, prepared);
}

}  // namespace retarget
