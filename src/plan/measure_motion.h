#pragma once

#include <memory>
#include <optional>
#include <string>

#include "options/option_table.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solve.h"

namespace retarget {

/// The source that motions are measured beside: what a plan makes of a clip.
struct MeasuredSource {
  std::string name;  ///< Of its file, without folder.
  FrameRate rate;
  HumanClip human;
  std::optional<HumanClip> human_with_lead_in;  ///< Where there is one.
  /// The same frames as they were read, of sources with fingers; else null.
  std::shared_ptr<const Clip> fingers, fingers_with_lead_in;
  BoneMap map;
  ResolvedConfig config;
  std::string config_file;  ///< As it is recorded.
  ScaleRule scale = ScaleRule::kTable;
};

/// Errors: prepare_clip's.
[[nodiscard]] Result<MeasuredSource> measured_source(Plan plan);

/// A motion's figures, and what of the source they are about.
struct MotionMeasure {
  QualityReport report;      ///< Without gates.
  bool has_lead_in = false;  ///< The motion follows the source with its leading frames.
  int source_frames = 0;     ///< Of the source from its start on; 0: there is none.
};

/// Measures a motion that was read from a file. It may have been made with the frames in front or
/// without them, and be a part alone: it is held against those that its limbs follow.
/// @param motion  at the source's rate.
/// @param source  null: none.
[[nodiscard]] MotionMeasure measure_motion(const RobotClip& motion, const LimitSet& limits,
                                           const MeasuredSource* source);

/// retarget::evaluate, and by inverse dynamics where it is asked for.
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion, bool dynamics);

/// The option that asks for it.
[[nodiscard]] Option dynamics_row(bool& dynamics);

}  // namespace retarget
