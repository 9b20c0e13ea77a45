#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "human/human_clip.h"
#include "retarget/motion_io.h"
#include "retarget/report.h"

namespace retarget::cli {

/// What all motions of one call are measured with.
struct Measures {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  ReadMotionOptions reading;
  FrameRate rate;  ///< Of the source.
  std::optional<HumanClip> human;
  std::optional<HumanClip> human_with_lead_in;  ///< Where there is one.
  std::optional<ResolvedConfig> config;
  HeightScale scale = HeightScale::kPublished;
  std::string source;  ///< File name.
  std::string config_file;
  Gates gates;
};

/// A motion as it was measured: frame by frame beside its source.
struct MeasuredMotion {
  RobotClip clip;
  const HumanClip* human = nullptr;  ///< One of the measures'; null: there is no source.
  QualityReport report;
};

/// Loads robot, limits, gates and source.
[[nodiscard]] Result<Measures> load_measures(const MeasureArguments& arguments, Console& console);

/// Reads a robot's motion and measures it; says what it was taken for.
[[nodiscard]] Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                                  Console& console);

}  // namespace retarget::cli
