#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/ik_config.h"
#include "retarget/load.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

/// Which bones a clip has, and how they become the canonical human.
struct HumanInClip {
  BoneMap map;
  Calibration calibration;

  /// What it was taken as, line by line.
  [[nodiscard]] std::vector<SummaryLine> lines() const;
  /// Why it may be understood wrongly.
  [[nodiscard]] const std::vector<Warning>& doubts() const { return calibration.mapping.doubts; }
  /// Bones without a place.
  [[nodiscard]] std::vector<Bone> missing_bones() const;
  /// Whether it has LAFAN1's own shape, for which the published mappings are made.
  [[nodiscard]] bool is_lafan1() const;
};

/// What is decided for a robot whatever the clip: loaded once for many.
struct RobotSetup {
  LoadedRobot loaded;
  LimitSet limits;
  ResolvedMapping mapping;  ///< For clips in LAFAN1's shape, and for all where there is no other.
  std::optional<ResolvedMapping> mapping_of_others;
  FitOptions fit;  ///< Of Method::kFit, with the file of options read and terms left out.

  [[nodiscard]] const ResolvedMapping& mapping_for(const HumanInClip& human) const;
};

/// How a clip becomes a robot's motion: every decision, made once and written down. A value: each
/// member may be read and replaced before solve().
struct Plan {
  std::shared_ptr<const Clip> clip;  ///< As it was read; null after solve(Plan&&).
  LoadedRobot robot;
  Options options;  ///< As they were given; what members below decide, they decide.

  HumanInClip human;

  FrameRange part;         ///< Frames of the clip that are taken.
  int lead_in_frames = 0;  ///< Of those left out in front, which are none of the motion.
  FrameRate rate;          ///< Of the motion.

  LimitSet limits;
  ResolvedMapping mapping;
  bool is_mapping_of_others = false;  ///< Chosen because the clip is not in LAFAN1's shape.
  HeightScale scale = HeightScale::kLimbs;
  FitOptions fit;
  std::vector<SummaryLine> clip_notes;     ///< What was left out of the clip, and why.
  std::vector<SummaryLine> mapping_notes;  ///< The same of the mapping.

  /// The robot, and by what the clip comes to it, line by line.
  [[nodiscard]] std::vector<SummaryLine> robot_lines() const;
  /// All that was decided as text, a line each.
  [[nodiscard]] std::string summary() const;
  /// Frames of the motion that solve() makes.
  [[nodiscard]] std::int64_t frame_count() const;
};

/// The human in a clip. A clip whose rotations do not carry its positions is given such as do.
/// @param data_folder  with configs/skeletons.
[[nodiscard]] Result<HumanInClip> find_human(Clip& clip, const HumanOptions& options,
                                             const std::string& data_folder);

/// Options that contradict each other (kUsage), and values and files that need no clip to be
/// refused.
[[nodiscard]] Result<void> check_options(const Options& options);

/// What options mean for a robot: limits, mappings, the fit's options.
[[nodiscard]] Result<RobotSetup> set_up_robot(LoadedRobot robot, const Options& options);

/// Decides how a clip becomes a robot's motion.
///
/// Errors: of kUsage, options that contradict each other; of kInput, a clip without frames, no human
/// in it, a part that is not there, more memory than is allowed; of kConfig, files of options.
[[nodiscard]] Result<Plan> make_plan(Clip clip, const RobotSetup& robot, const Options& options);
[[nodiscard]] Result<Plan> make_plan(Clip clip, const LoadedRobot& robot,
                                     const Options& options = {});

/// A plan as JSON: the run that it is of, and every decision by its value. The same plan gives the same
/// text.
/// @pre the plan has its clip
[[nodiscard]] std::string plan_json(const Plan& plan);

/// Reads such a file, its clip and its robot. What was decided is taken as it stands there and not
/// decided again, so that a decision may be changed in the file.
/// Errors (kConfig): the file's faults, all at once; those of load_clip and load_robot.
[[nodiscard]] Result<Plan> load_plan(const std::string& file, const DataFolder& data_folder = {});

}  // namespace retarget
