#include "retarget/robot/mujoco_version.h"

#include <mujoco/mujoco.h>

namespace retarget {

MujocoVersion mujoco_version() {
  return {mujoco_version_text(mjVERSION_HEADER), mujoco_version_text(mj_version()),
          mjVERSION_HEADER == mj_version()};
}

std::string mujoco_version_text(int number) {
  const int base = number > 99999 ? 1000 : 10;
  return std::to_string(number / (base * base)) + "." + std::to_string(number / base % base) + "." +
         std::to_string(number % base);
}

}  // namespace retarget
