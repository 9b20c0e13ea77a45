#pragma once

#include <array>
#include <string>
#include <vector>

#include "retarget/batch.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/run.h"
#include "retarget/serve_table.h"

namespace retarget::cli {

/// Arguments that all commands share.
struct CommonArguments {
  bool quiet = false;
  std::string data_dir;  ///< Folder that holds robots/ and configs/; empty: found automatically.
};

/// Arguments of the default command: converts one clip to robot motion files.
struct RunArguments {
  CommonArguments common;
  Run run;
  RunRequest request;              ///< Except its gates and drawings.
  std::string html;                ///< Page that plays the motion; empty: none.
  std::string png;                 ///< Picture with a strip of poses; empty: none.
  int strip = 0;                   ///< Number of poses in the strip; 0: the default.
  std::vector<std::string> gates;  ///< As for changed_gates(); empty: gates do not affect the exit
                                   ///< code.
  std::string smpl_file;           ///< Replaces the run's motion.
  std::array<std::string, 2> words;  ///< Motion and robot given without option names.
};

/// Arguments of `retarget batch`: many clips, to one or several robots.
struct BatchArguments {
  /// Options of every clip, except its file, robot and output; the memory limit applies to the
  /// batch as a whole.
  RunArguments run;
  BatchRequest request;  ///< Except what `run` contains, the data folder and `quality`.
  bool merge = false;
  bool no_quality = false;
};

/// Arguments of commands that measure robot motions.
struct MeasureArguments {
  RunArguments run;                  ///< Robot, limits, source and its start time, frame rate.
  std::string fps;                   ///< As given; empty: not given.
  ReadingOptions reading;            ///< Except the rate, if `run` has it.
  std::vector<std::string> motions;  ///< Robot motion files.
  std::vector<std::string> gates;    ///< As for changed_gates().
  bool dynamics = false;             ///< Also compute inverse dynamics metrics.
};

/// Arguments of `retarget evaluate`, which measures the quality of robot motions.
struct EvaluateArguments : MeasureArguments {
  std::string json;  ///< Report to write; empty: none, `-`: standard output.
  bool all = false;  ///< Print every figure.
};

/// Arguments of `retarget certify`, which measures, simulates and predicts one motion.
struct CertifyArguments : MeasureArguments {
  std::string output;  ///< Certificate to write; empty: the motion's name with .certificate.json.
};

/// Arguments of `retarget verify`, which checks that a run still gives the same bytes.
struct VerifyArguments {
  CommonArguments common;
  std::string file;  ///< The sidecar, or a certificate.
};

/// Arguments of `retarget convert`, which converts robot motions between formats.
struct ConvertArguments {
  CommonArguments common;
  ConvertRequest request;
};

/// Arguments of `retarget simulate`, which replays a robot motion in a physics simulation.
struct SimulateArguments {
  CommonArguments common;
  RobotChoice robot;
  double memory_gb = 0.0;
  ReadingOptions reading;
  SaveOptions save;
  std::string input;
  std::string output;  ///< Simulated motion; empty: none.
  std::string report;  ///< Report to write as JSON; empty: none.
  bool json = false;   ///< Print the report as JSON.
};

/// Arguments of `retarget compare`, which checks whether two motions agree.
struct CompareArguments {
  CommonArguments common;
  RobotChoice robot;
  double memory_gb = 0.0;
  ReadingOptions reading;
  std::string a, b;
  double tolerance = 1e-6;
};

/// Arguments of `retarget inspect`, which shows the contents of a motion file.
struct InspectArguments {
  RunArguments run;  ///< The file, how to read it, and how to recognise the human in it.
  bool skeleton_only = false;
  bool json = false;
  std::string positions;  ///< CSV to write; empty: none.
  std::string html;       ///< Page to write instead of the text; empty: none.
};

/// Arguments of `retarget contacts`, which lists the contacts that a run holds.
struct ContactsArguments {
  RunArguments run;  ///< Motion, robot, and how the run solves.
  std::string json;  ///< File to write; empty: none, `-`: standard output instead of the table.
};

/// Arguments of `retarget scene-from-motion`, which writes the boxes that a human rests on.
struct SceneFromMotionArguments {
  RunArguments run;    ///< The file, how to read it, and how to recognise the human in it.
  std::string output;  ///< Scene to write; empty: none.
};

/// Arguments of `retarget view`: a picture of a robot motion, or a page that plays several.
struct ViewArguments : MeasureArguments {
  std::vector<std::string> labels;  ///< One per motion of a page; empty: file names.
  std::string meshes;               ///< For a page: a folder or another model; empty: none.
};

/// Subcommands of `retarget robots`.
enum class RobotsAction : unsigned char { kList, kShow, kCheck, kCompare, kAdd, kInstall };

/// Arguments of `retarget robots`, which lists, shows, checks, adds and installs robots.
struct RobotsArguments {
  CommonArguments common;
  RobotsAction action = RobotsAction::kList;
  std::string robot;         ///< Name, folder, or model file (check only); the name of a new robot.
  std::string model;         ///< MJCF or URDF of a new robot.
  std::string output = ".";  ///< Parent folder for a new robot's folder.
  std::vector<std::string> names;  ///< Robots to install; empty: all that are not installed.
  std::string source;              ///< Source to install from.
  std::string install_folder;      ///< Destination folder; empty: the user's own.
  bool force = false;              ///< Replace an existing folder.
  RobotBase base = RobotBase::kAuto;
  bool json = false;
};

/// Arguments of `retarget live`: converts a stream, or a clip played as a stream, to robot frames.
struct LiveArguments {
  ServeRequest request;
  CommonArguments common;
  std::string play;  ///< Clip to play as a stream; empty: none.
  PlayOptions player;
  bool list = false;
};

}  // namespace retarget::cli
