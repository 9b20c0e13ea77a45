#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/motion_scene.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/scene.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// Motion files to measure, and the source to compare them with.
struct MeasureRequest {
  /// Robot, limits, and options for reading and interpreting the source. `motion` is the source;
  /// empty: none, and metrics that need a source are omitted.
  Run run;
  RunRequest of_source;              ///< Mirroring and bone-map file of the source.
  std::string fps;                   ///< Frame rate of the source, and of motions whose files have
                                     ///< none, in frames per second, or `source`; empty: that of
                                     ///< the first motion, and the format's default.
  ReadingOptions reading;            ///< Facts that the motion files do not state.
  std::vector<std::string> motions;  ///< Motion files; load_measures() reads only their sidecars,
                                     ///< and the first motion if the source needs its rate.
  std::vector<std::string> gates;    ///< Gate texts of changed_gates().
  bool dynamics = false;             ///< Also compute inverse dynamics metrics.
  DataFolder data_folder;
};

/// A motion file that load_measures() has read, which may be standard input.
struct ReadMotion {
  std::string file;
  std::shared_ptr<const RobotMotion> motion;  ///< Null: none.
};

/// Robot, source and gates that all measurements of a request use.
struct Measures {
  std::shared_ptr<const Robot> robot;
  std::string model;  ///< The robot's model, MJCF or URDF.
  LimitSet limits;
  ReadMotionOptions reading;
  FrameRate rate;    ///< Frame rate of the source.
  ReadMotion first;  ///< The first motion, if it was read for its rate.
  std::optional<MeasuredSource> source;
  /// Without a source: the scene of the options, used as the robot's scene; null: none.
  std::shared_ptr<const Scene> scene;
  std::vector<ObjectTrack> object_tracks;  ///< Paths of that scene's objects.
  Gates gates;
  bool dynamics = false;
};

/// Loads robot, limits, gates and source. Without a given variant of the robot, uses the variant
/// that the sidecars of all motions record.
/// Errors: those of load_robot, changed_gates, load_recorded_motion, read_and_plan, load_scene and
/// load_object_track; an invalid rate, or tracks without a scene (kUsage).
[[nodiscard]] Result<Measures> load_measures(const MeasureRequest& request, Observer& observer);

/// A measured motion, resampled to the source's frames.
struct MeasuredMotion {
  RobotClip clip;
  const HumanClip* human = nullptr;    ///< Human of the source, if any; otherwise null.
  QualityReport report;                ///< Judged by the gates.
  std::optional<FrameRate> file_rate;  ///< The file's rate, if the motion was resampled to the
                                       ///< source's.
};

/// Reads and measures a motion file.
/// @param measures  must outlive the result.
/// Errors: those of load_recorded_motion.
[[nodiscard]] Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                                  Observer& observer);

/// Whether options select a part of the source.
[[nodiscard]] bool has_part(const PartOptions& part);

/// Options that select the whole source, with the same lead-in.
[[nodiscard]] PartOptions without_part(const PartOptions& part);

/// A motion and the run that made it; for a file, its sidecar records the run (recorded_run).
struct RecordedMotion {
  std::string file;  ///< Name in messages.
  std::optional<RecordedRun> recorded;
  /// Set if the motion is a part of that of the run: time of its first frame, seconds.
  std::optional<double> part_start = std::nullopt;
};

/// A motion beside its source, in the same frames.
struct MotionBeside {
  HumanClip human;       ///< May be longer or shorter.
  QualityReport report;  ///< Without gates.
};

/// Measures a motion against a clip in memory, as measure_file() does with files: takes part,
/// mirroring, travel and time scale of the source from the record, unless options give them, and
/// reports the same warnings.
/// @param motion  is resampled to the rate of the options.
/// Errors: those of set_up_robot, make_plan and measured_source.
[[nodiscard]] Result<MotionBeside> measure_against(const RobotClip& motion,
                                                   const RecordedMotion& record, Clip source,
                                                   LoadedRobot robot, const Options& options,
                                                   bool dynamics, Observer& observer);

/// The scene of a measured motion; null without a scene. With a source, it is the scene that a fit
/// derives from the human's, and motions of the same human share it. Without a source, it is the
/// scene of the options, in the frames of the motion.
/// Errors: those of motion_scene and place_scene.
[[nodiscard]] Result<std::shared_ptr<const MotionScene>> measured_scene(
    const MeasuredMotion& motion, const Measures& measures);

}  // namespace retarget
