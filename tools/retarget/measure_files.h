#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "retarget/measure.h"
#include "retarget/motion_io.h"
#include "retarget/report.h"

namespace retarget::cli {

/// Common inputs for measuring all motions of a call.
struct Measures {
  std::shared_ptr<const Robot> robot;
  std::string model;  ///< The robot's model, MJCF or URDF.
  LimitSet limits;
  ReadMotionOptions reading;
  FrameRate rate;  ///< Frame rate of the source.
  std::optional<MeasuredSource> source;
  Gates gates;
  bool dynamics = false;
};

/// A measured motion, resampled to the source's frames.
struct MeasuredMotion {
  RobotClip clip;
  const HumanClip* human = nullptr;  ///< Human of the source, if any; otherwise null.
  QualityReport report;
  std::optional<FrameRate> file_rate;  ///< The file's rate, if the motion was resampled to the
                                       ///< source's.
};

/// Checks motions and source for errors that do not depend on the command: an option that needs a
/// source without one, standard input given twice.
/// @return all files that will be read.
[[nodiscard]] Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments);

/// Loads robot, limits, gates and source.
/// @param source_rate  rate for the source if the arguments have none; it does not apply to motions
///   whose files state no rate.
[[nodiscard]] Result<Measures> load_measures(const MeasureArguments& arguments, Console& console,
                                             const std::optional<FrameRate>& source_rate = {});

/// Reads and measures a robot motion; prints how the file was interpreted.
[[nodiscard]] Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                                  Console& console);

}  // namespace retarget::cli
