#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "retarget/human.h"
#include "retarget/live.h"
#include "retarget/retarget.h"
#include "support/value_of.h"

namespace retarget {

/// Stream plans for the samples and the G1.
inline const LoadedRobot& sample_robot() {
  static const LoadedRobot robot =
      load_robot({"unitree_g1", {}, {}, {}}, DataFolder{RETARGET_SOURCE_DIR}).value();
  return robot;
}

/// The same robot, with only the arms following.
inline const LoadedRobot& sample_robot_arms() {
  static const LoadedRobot robot = [] {
    RobotChoice choice;
    choice.name = "unitree_g1";
    choice.follow = Follow::kArms;
    return load_robot(choice, DataFolder{RETARGET_SOURCE_DIR}).value();
  }();
  return robot;
}

inline Plan sample_plan(const std::string& name, Method method,
                        const LoadedRobot& robot = sample_robot()) {
  auto clip = value_of(load_clip(RETARGET_SOURCE_DIR "/data/" + name + ".bvh"));
  Options options;
  options.solve.method = method;
  options.time.fps = std::nullopt;
  return value_of(make_plan(std::move(clip), robot, options));
}

/// The human in a plan's clip, frame by frame.
inline HumanClip human_of(const Plan& plan) {
  return to_human(*plan.clip, plan.human.calibration);
}

inline const Plan& walk_plan() {
  static const Plan plan = sample_plan("walk", Method::kFit);
  return plan;
}

inline const HumanClip& walking_human() {
  static const HumanClip human = human_of(walk_plan());
  return human;
}

/// The output of a session for a clip that arrives frame by frame, without delay.
inline std::vector<std::vector<double>> streamed(LiveSession& session, const HumanClip& human,
                                                 double begin = 0.0) {
  std::vector<std::vector<double>> frames;
  const auto take = [&](double now) {
    while (const auto frame = session.pull(now)) {
      frames.emplace_back(frame->qpos.begin(), frame->qpos.end());
    }
  };
  for (int i = 0; i < human.frame_count; ++i) {
    const double time = begin + human.rate.time_of(i);
    session.push({time, human.frame(i)}, time);
    take(time);
  }
  session.finish();
  take(begin + human.rate.time_of(human.frame_count));
  return frames;
}

}  // namespace retarget
