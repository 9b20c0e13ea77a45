#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/measure.h"
#include "retarget/report.h"
#include "support/still_human.h"
#include "support/temporary_folder.h"
#include "support/test_robots.h"

namespace retarget {

/// Two feet on legs of hinges, with spheres above them that hinges can bring into overlap.
inline constexpr const char* kWalker = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base">
      <freejoint/>
      <body name="left_foot" pos="0 0.1 -0.5">
        <joint name="left" axis="0 0 1" range="-3 3"/>
        <geom type="sphere" size="0.05" pos="0 0 0.05"/>
      </body>
      <body name="right_foot" pos="0 -0.1 -0.5">
        <joint name="right" axis="0 0 1" range="-1 1"/>
        <geom type="sphere" size="0.05" pos="0 0 0.05"/>
      </body>
      <body name="hand" pos="0 0 0.2">
        <joint name="arm" type="slide" axis="0 1 0"/>
        <geom type="sphere" size="0.1"/>
      </body>
      <body name="knob" pos="0 0.3 0.2">
        <joint name="knob" axis="0 0 1"/>
        <geom type="sphere" size="0.1"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";

inline constexpr const char* kWalkerProfile = R"({
  "name": "walker",
  "limit_sets": {"narrow": {"ranges": {"left": [-0.1, 0.1]}}},
  "speed_limits": {"right": 4.0},
  "soles": {
    "left": {"body": "left_foot", "points": [[-0.1, 0, 0], [0.1, 0, 0]]},
    "right": {"body": "right_foot", "points": [[-0.1, 0, 0], [0.1, 0, 0]]}
  }
})";

inline constexpr int kX = 0, kZ = 2;
inline constexpr int kLeft = 7, kRight = 8, kArm = 9, kKnob = 10;

using Movement = std::function<void(int frame, std::span<double> qpos)>;

class MeasureQuality : public ::testing::Test {
 protected:
  void SetUp() override {
    const TemporaryFolder folder;
    robot_ = load_robot_files(folder.write("walker.xml", kWalker),
                              folder.write("robot.json", kWalkerProfile))
                 .value();
  }

  // Makes a walk with soles on the floor except for the given movement.
  RobotClip make(int frames, const Movement& movement) const {
    RobotClip clip(robot_, {30, 1}, frames);
    for (int frame = 0; frame < frames; ++frame) {
      clip.qpos(frame)[kZ] = 0.5;
      movement(frame, clip.qpos(frame));
    }
    return clip;
  }
  QualityReport measure(int frames, const Movement& movement,
                        const HumanClip* human = nullptr) const {
    const QualitySource source{human, nullptr, ScaleRule::kTable};
    return measure_quality(make(frames, movement), robot_->model_limits(),
                           human == nullptr ? nullptr : &source);
  }

  std::shared_ptr<const Robot> robot_;
};

inline double figure(const QualityReport& report, std::string_view key) {
  const MetricValue* found = report.find(key);
  EXPECT_NE(found, nullptr) << key;
  return found == nullptr ? std::nan("") : found->value;
}

inline std::vector<Fault> faults_of(const QualityReport& report, const std::string& metric) {
  std::vector<Fault> found;
  for (const Fault& fault : report.faults) {
    if (fault.metric == metric) found.push_back(fault);
  }
  return found;
}

/// A human whose feet stand for a second.
inline HumanClip standing_human(int frames) {
  std::vector<std::pair<std::string, Eigen::Vector3d>> places;
  for (const auto& [side, y] : {std::pair{"Left", 0.1}, {"Right", -0.1}}) {
    places.emplace_back(side + std::string("UpLeg"), Eigen::Vector3d(0.0, y, 0.93));
    places.emplace_back(side + std::string("Leg"), Eigen::Vector3d(0.0, y, 0.5));
    places.emplace_back(side + std::string("Foot"), Eigen::Vector3d(0.0, y, 0.08));
    places.emplace_back(side + std::string("Toe"), Eigen::Vector3d(0.1, y, 0.02));
  }
  return still_human(places, frames);
}

}  // namespace retarget
