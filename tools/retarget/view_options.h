#pragma once

#include "options.h"

namespace retarget::cli {

/// `retarget view`: a picture of a robot's motion.
struct ViewOptions {
  RunOptions run;  ///< Robot, source and its start; the output.
  ReadingOptions reading;
  std::string motion;
  int strip = 6;  ///< Poses.
};

}  // namespace retarget::cli
