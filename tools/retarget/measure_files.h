#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "plan/measure_motion.h"
#include "retarget/motion_io.h"
#include "retarget/report.h"

namespace retarget::cli {

/// What all motions of one call are measured with.
struct Measures {
  std::shared_ptr<const Robot> robot;
  std::string model;  ///< The robot's, MJCF or URDF.
  LimitSet limits;
  ReadMotionOptions reading;
  FrameRate rate;  ///< Of the source.
  std::optional<MeasuredSource> source;
  Gates gates;
  bool dynamics = false;
};

/// A motion as it was measured: frame by frame beside its source.
struct MeasuredMotion {
  RobotClip clip;
  const HumanClip* human = nullptr;  ///< Of the measures' source; null: there is none.
  QualityReport report;
  std::optional<FrameRate> file_rate;  ///< Of the file, if it was resampled to the source's.
};

/// What is wrong with motions and source whatever the command does with them: an option that needs a
/// source without one, standard input named twice.
/// @return all files that are read.
[[nodiscard]] Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments);

/// Loads robot, limits, gates and source.
/// @param source_rate  that the source is looked at with where the arguments have no rate; it says
///                     nothing of motions whose files give none.
[[nodiscard]] Result<Measures> load_measures(const MeasureArguments& arguments, Console& console,
                                             const std::optional<FrameRate>& source_rate = {});

/// Reads a robot's motion and measures it; says what it was taken for.
[[nodiscard]] Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                                  Console& console);

}  // namespace retarget::cli
