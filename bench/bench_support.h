#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "formats/bvh/read_bvh.h"
#include "retarget/human.h"
#include "retarget/load_robot.h"
#include "retarget/retargeting_config.h"
#include "solve/targets/targets.h"
#include "support/lafan1_map.h"

namespace retarget {

/// The G1, its configuration and a clip, loaded once per benchmark.
struct BenchCase {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
  LimitSet limits;
  HumanClip human;
};

/// The folder of real clips, or the repository's samples if it is missing.
inline std::filesystem::path clip_path(const std::string& name) {
  const std::filesystem::path source = RETARGET_SOURCE_DIR;
  const char* chosen = std::getenv("RETARGET_SHARED");
  const auto shared = chosen != nullptr ? std::filesystem::path(chosen) : source / ".." / "shared";
  const auto real = shared / "data" / "lafan1" / (name + ".bvh");
  return std::filesystem::exists(real) ? real : source / "data" / "walk.bvh";
}

inline BenchCase load_case(const std::string& clip) {
  const std::filesystem::path source = RETARGET_SOURCE_DIR;
  BenchCase result;
  result.robot = load_robot_files((source / "robots/unitree_g1/model.xml").string(),
                                  (source / "robots/unitree_g1/robot.json").string())
                     .value();
  result.config =
      load_config((source / "configs/lafan1_to_unitree_g1.json").string(), *result.robot).value();
  result.limits = load_limits(*result.robot, "gmr").value();
  const auto file = load_bvh(clip_path(clip).string()).value();
  result.human = to_human(file.clip, lafan1_calibration(file.clip.skeleton()));
  return result;
}

}  // namespace retarget
