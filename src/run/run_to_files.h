#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "run/observer.h"
#include "run/outputs.h"

namespace retarget {

/// What is written, said and measured beside the motion of a run.
struct RunRequest {
  std::string report;     ///< JSON of the motion's quality; empty: none.
  std::string html;       ///< Page that plays the motion; empty: none.
  std::string png;        ///< Strip of poses; empty: none,
  int strip = 0;          ///< and how many; 0: as many as a strip has by default.
  std::string write_map;  ///< Where to write which joint was taken for which bone; empty: nowhere.
  bool sidecar = false;   ///< Write `<output>.json` beside each file.
  bool measure = false;   ///< Measure the motion's quality, whether it is written or not.
  bool verbose = false;   ///< Say what the terms of the fit cost.
  bool mirror = false;    ///< Of the clip the mirror image is taken, left for right.
  bool hashes_only = false;    ///< Write nothing, make the hashes alone.
  bool dynamics = false;       ///< What is measured includes figures of inverse dynamics.
  int threads = 0;             ///< Of one clip; 0: as many as serve. The result is the same.
  std::optional<Gates> gates;  ///< For the motion, which is measured then; empty: the default ones.
};

/// What became of a run.
struct RunOutcome {
  int frames = 0;                        ///< Of the motion that was written,
  double fps = 0.0;                      ///< and its rate.
  std::string config;                    ///< The configuration's file.
  std::vector<WrittenFile> motions;      ///< The motion's files, with their hashes.
  std::vector<std::string> others;       ///< Sidecars, report, page and picture.
  std::optional<QualityReport> quality;  ///< Where it was asked for.
};

/// load_robot that tells what was found for it.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const DataFolder& data_folder, Observer& observer,
                                             Soles soles = Soles::kFound);

/// Reads the clip of a run and decides what becomes of it; tells what was found
/// in it.
[[nodiscard]] Result<Plan> read_and_plan(const Run& run, const RunRequest& request,
                                         const RobotSetup& robot, Observer& observer);

/// One clip from its file to the files that a run names: the motion, sidecars, report, page, picture. All appear
/// once everything was solved and written, or none.
[[nodiscard]] Result<RunOutcome> run_to_files(const Run& run, const RunRequest& request,
                                              const RobotSetup& robot, Observer& observer);

}  // namespace retarget
