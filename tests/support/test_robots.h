#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "retarget/retargeting_config.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {

/// Loads a robot from MJCF text.
inline std::shared_ptr<const Robot> robot_from_text(const std::string& mjcf) {
  const TemporaryFolder folder;
  return value_of(load_robot_files(folder.write("robot.xml", mjcf)));
}

/// Loads a robot's folder.
inline std::shared_ptr<const Robot> load_robot_in(const std::filesystem::path& folder) {
  return value_of(
      load_robot_files((folder / "model.xml").string(), (folder / "robot.json").string()));
}

/// Loads the repository's Unitree G1 with its profile.
inline std::shared_ptr<const Robot> load_g1() {
  return load_robot_in(RETARGET_SOURCE_DIR "/robots/unitree_g1");
}

/// Loads the G1's published retargeting configuration for LAFAN1.
inline ResolvedConfig published_config(const Robot& g1) {
  return value_of(load_config(RETARGET_SOURCE_DIR "/configs/lafan1_to_unitree_g1.json", g1));
}

/// Two arms on a floating base, with hinges about different axes, an anchor off the origin, a slide
/// and an unlimited joint.
inline constexpr const char* kTwoArms = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 1">
      <freejoint/>
      <geom size="0.1" mass="1"/>
      <body name="left_upper" pos="0 0.2 0.1" quat="0.9 0.1 0.2 0.3">
        <joint name="left_shoulder" axis="0 1 0" range="-1 1.5"/>
        <geom size="0.05" mass="1"/>
        <body name="left_lower" pos="0 0.3 0">
          <joint name="left_elbow" axis="1 0 1" pos="0 -0.05 0.02" range="0 2.5"/>
          <joint name="left_twist" axis="0 1 0"/>
          <geom size="0.05" mass="1"/>
        </body>
      </body>
      <body name="right_upper" pos="0 -0.2 0.1">
        <joint name="right_slide" type="slide" axis="0 0 1" range="-0.2 0.2"/>
        <joint name="right_shoulder" axis="1 0 0" range="-2 0.5" ref="0.1"/>
        <geom size="0.05" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";

/// A robot with slides, reference positions, several joints on a body, bodies fixed to other bodies
/// and to the world, and rotor inertias.
inline constexpr const char* kOddRobot = R"(
<mujoco>
  <compiler angle="degree" eulerseq="zyx"/>
  <worldbody>
    <body name="stand" pos="3 2 1" euler="10 20 30"><geom size="0.1"/></body>
    <body name="base" pos="0.1 0.2 0.3" quat="2 1 0 1">
      <freejoint/>
      <geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>
      <body name="hand" pos="0.3 -0.2 0.5" euler="30 40 50">
        <joint name="rail" type="slide" axis="1 2 3" ref="0.2" armature="0.3"/>
        <joint name="turn" axis="0 1 1" pos="0.1 0.2 0.3" ref="20" armature="0.02"/>
        <joint name="tilt" axis="1 0 0" pos="-0.1 0.3 0"/>
        <joint name="drop" type="slide" axis="0 -1 0"/>
        <geom size="0.1" pos="0 0.1 0"/>
        <body name="tip" pos="0 0 0.2" axisangle="1 1 0 33">
          <geom type="capsule" size="0.02 0.2" pos="0.2 0 0"/>
          <body name="claw" pos="0.1 0 0"><joint name="grip" axis="0 1 0" ref="-30"/>
            <geom size="0.1"/></body>
        </body>
      </body>
      <body name="post" pos="0 0 1" euler="0 90 0">
        <geom type="box" size="0.1 0.02 0.3"/>
        <body name="flag" pos="0 0 1"><joint name="wave" axis="0 0 1"/><geom size="0.1"/></body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

}  // namespace retarget
