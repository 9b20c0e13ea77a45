#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "batch/run_batch.h"
#include "io/reading_table.h"
#include "retarget/options.h"
#include "run/run_to_files.h"
#include "stream/serve.h"

namespace retarget::cli {

/// Arguments that all commands share.
struct CommonArguments {
  bool quiet = false;
  std::string data_dir;  ///< Folder that holds robots/ and configs/; empty: found.
};

/// The default command: one clip to the files of a robot's motion.
struct RunArguments {
  CommonArguments common;
  Run run;
  RunRequest request;                ///< But for its gates.
  std::vector<std::string> gates;    ///< As changed_gates() takes them; none: they do not decide.
  std::string smpl_file;             ///< In place of the run's motion.
  std::array<std::string, 2> words;  ///< Motion and robot that are named without an option.
};

/// `retarget batch`: many clips, to one robot or several.
struct BatchArguments {
  /// Of every clip but for its file, robot and output; its memory is that of all together.
  RunArguments run;
  BatchRequest request;  ///< All but what `run` says, the data folder and `quality`.
  bool merge = false;
  bool no_quality = false;
};

/// Robot motions that are measured.
struct MeasureArguments {
  RunArguments run;                  ///< Robot, limits, source and its start; the rate.
  std::string fps;                   ///< As given; empty: not.
  ReadingOptions reading;            ///< But for the rate, where `run` has it.
  std::vector<std::string> motions;  ///< Files of robot motions.
  std::vector<std::string> gates;    ///< As changed_gates() takes them.
  bool dynamics = false;             ///< Figures of inverse dynamics, too.
};

/// `retarget evaluate`: how good robot motions are.
struct EvaluateArguments : MeasureArguments {
  std::string json;  ///< Report to write; empty: none, `-`: standard output.
};

/// `retarget verify`: whether a run still gives the same bytes.
struct VerifyArguments {
  CommonArguments common;
  std::string file;  ///< The sidecar.
};

/// `retarget convert`: robot motions from one format to another.
struct ConvertArguments {
  CommonArguments common;
  RobotChoice robot;
  double memory_gb = 0.0;
  ReadingOptions reading;
  TimeOptions time{.fps = std::nullopt};
  SaveOptions save;
  std::string input, output;
};

/// `retarget compare`: whether two motions agree.
struct CompareArguments {
  CommonArguments common;
  RobotChoice robot;
  double memory_gb = 0.0;
  ReadingOptions reading;
  std::string a, b;
  double tolerance = 1e-6;
};

/// `retarget inspect`: what a motion file holds.
struct InspectArguments {
  RunArguments run;  ///< The file, how it is read, the human in it.
  bool skeleton_only = false;
  bool json = false;
  std::string positions;  ///< CSV to write; empty: none.
  std::string html;       ///< Page to write in place of the text; empty: none.
};

/// `retarget view`: a picture of a robot's motion, or a page that plays several.
struct ViewArguments : MeasureArguments {
  std::vector<std::string> labels;  ///< By motion, of a page; empty: names of the files.
  std::string meshes;               ///< Of a page: a folder or another model; empty: none.
};

/// What `retarget robots` does.
enum class RobotsAction : unsigned char { kList, kShow, kCheck, kAdd };

/// `retarget robots`: what robots there are, what is odd about them, new ones.
struct RobotsArguments {
  CommonArguments common;
  RobotsAction action = RobotsAction::kList;
  std::string robot;         ///< Name, folder, or (check) a model file; of a new robot its name.
  std::string model;         ///< Of a new robot: MJCF or URDF.
  std::string output = ".";  ///< Folder that a new robot's folder goes into.
  bool force = false;        ///< Replace an existing folder.
  RobotBase base = RobotBase::kAuto;
  bool json = false;
};

/// `retarget live`: a stream in, a robot's frames out; or a clip that is played as a stream.
struct LiveArguments {
  RunArguments run;    ///< Robot, method, how the human is recognised.
  ServeOptions serve;  ///< But for its pipeline's options of a run, and the skeleton.
  bool plain = false;  ///< The published method alone.
  std::string skeleton;
  std::string play;  ///< A clip's file; empty: nothing is played.
  PlayOptions player;
  bool list = false;
};

}  // namespace retarget::cli
