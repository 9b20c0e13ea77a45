#include "motions.h"

#include "retarget/load.h"

std::string folder_of_robots() {
  const auto robot = retarget::load_robot("unitree_g1");
  return robot ? robot->data_folder : std::string();
}
