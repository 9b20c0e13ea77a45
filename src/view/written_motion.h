#pragma once

#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/normalize_start.h"
#include "retarget/solve.h"

namespace retarget {

/// A solved motion as it is written, and its source frame by frame.
struct WrittenMotion {
  RobotClip clip;
  HumanClip human;

  explicit WrittenMotion(const Motion& motion)
      : clip(motion.clip), human(to_human(*motion.source, motion.plan.human.calibration)) {
    if (motion.plan.options.save.normalize_start) normalize_start(clip);
  }
};

}  // namespace retarget
