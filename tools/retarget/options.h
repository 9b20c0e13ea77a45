#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace retarget::cli {

/// Options that many commands share.
struct CommonOptions {
  bool quiet = false;
  std::string data_dir;  ///< Folder that holds robots/ and configs/; empty: found.
};

/// How a source clip is read.
struct SourceOptions {
  std::string file;        ///< `-` for standard input.
  bool smpl = false;       ///< An SMPL or SMPL-X motion instead of BVH.
  std::string smpl_model;  ///< The user's body model; empty: a generic body.
  bool lenient = false;
  std::string root;         ///< Which of several ROOTs.
  double source_fps = 0.0;  ///< 0: as the file says.
  double memory_gb = 0.0;   ///< That a clip may need; 0: three quarters of what there is.
};

/// How the human in a clip is found and measured.
struct HumanOptions {
  std::string map;        ///< Mapping file in place of recognition.
  std::string write_map;  ///< Where to write the mapping that was used.
  bool partial = false;   ///< Arms or legs may be missing.
  std::string rest = "auto";
  int tpose_frame = -1;    ///< Negative: not given.
  std::string tpose_file;  ///< A clip whose first frame is the T-pose.
  std::string unit;        ///< A name or metres; empty: found.
  std::string up;          ///< `y`, `-z`, ...; empty: found.
  std::string forward;
  double height = 0.0;         ///< Metres; 0: estimated.
  bool unit_optional = false;  ///< No option: what is done needs no unit.
};

/// Which files a motion goes to, and how they are written.
struct OutputOptions {
  std::string output;                ///< `-`: standard output.
  std::vector<std::string> formats;  ///< Empty: by the output's ending.
  int precision = 6;
  std::string delimiter = "comma";
  bool header = false;
  std::string quaternion = "xyzw";
  bool frame_column = false;
  bool degrees = false;
  bool centimetres = false;
  bool normalize_start = false;
  int npz_fps = 50;
  std::string npz_velocity;  ///< `link` or `mass`; empty: the format's own.
  std::string motion_name;   ///< In PBHC's files; empty: by the output's name.
  bool sidecar = false;      ///< Write `<output>.json` beside each file.
};

/// The default command: one clip to the files of a robot's motion.
struct RunOptions : OutputOptions {
  CommonOptions common;
  SourceOptions source;
  std::string smpl_file;             ///< In place of the source's file.
  std::array<std::string, 2> words;  ///< Motion and robot that are named without an option.
  HumanOptions human;
  double start_s = -1.0;  ///< Negative: not given.
  double end_s = -1.0;
  std::string frames;  ///< `a:b`; empty: not given.
  /// Frames in front that are none of the motion: `drop`, `keep`, `auto` as is best for the method.
  std::string lead_in = "auto";

  std::string robot;
  std::string robot_xml;
  std::string robot_profile;
  std::string dof;        ///< Variant of the robot; empty: all of it.
  std::string limits;     ///< Empty: the method's own.
  std::string ik_config;  ///< A file, `published` or `derived`; empty: as is best for the source.
  std::string method = "fit";
  std::string fit_config;            ///< Options of the fit, JSON; empty: the defaults.
  double fit_window_s = 0.0;         ///< Seconds that a fit solves together; 0: its own.
  std::vector<std::string> without;  ///< Terms of the fit to leave out.
  std::string engine = "fast";
  std::string scale = "auto";

  std::string fps = "30";  ///< A number or `source`.
  std::string interpolation = "cubic";
  bool no_antialias = false;

  std::string report;  ///< JSON of the motion's quality; empty: none.

  bool verbose = false;  ///< Say what the terms of the fit cost.
  bool measure = false;  ///< Measure the motion's quality, whether it is written or not.
  int threads = 0;       ///< Of one clip; 0: as many as serve. The result is the same.
};

/// `retarget batch`: many clips, to one robot or several.
struct BatchOptions {
  /// Of every clip but for its file, robot and output; its memory is that of all together.
  RunOptions run;
  std::vector<std::string> inputs;   ///< Files, folders, patterns, `@LIST`; with merge: manifests.
  std::vector<std::string> lists;    ///< Files of names.
  std::string base;                  ///< Folder below which named files keep their tree.
  std::vector<std::string> exclude;  ///< Shell patterns.
  std::vector<std::string> robots;
  std::string output;           ///< Folder.
  int jobs = 0;                 ///< Clips at a time; 0: as many as there are processors.
  double clip_timeout_s = 0.0;  ///< After which a clip has failed; 0: never.
  bool resume = false;
  bool redo = false;
  std::string shard;  ///< `I/N`; empty: all of it.
  bool merge = false;
  bool no_quality = false;
  /// Every option that may change a clip's output, as given or by default; filled by the parser.
  std::vector<std::pair<std::string, std::vector<std::string>>> deciding;
};

/// What a file of a robot's motion does not say; empty: found.
struct ReadingOptions {
  std::string from;         ///< Format in place of what the content says.
  double source_fps = 0.0;  ///< 0: as the file says.
  std::string quaternion;   ///< `xyzw`, `wxyz`.
  std::string angles;       ///< `rad`, `deg`.
  std::string unit;         ///< `m`, `cm`, `mm`.
  std::string dof;          ///< Variant of the robot that the columns are of.
  std::string motion;       ///< One of several in a PBHC file.
  bool ignore_header = false;
};

/// `retarget evaluate`: how good robot motions are.
struct EvaluateOptions {
  RunOptions run;                    ///< Robot, limits, source and its start; the rate.
  ReadingOptions reading;            ///< But for the rate.
  std::vector<std::string> motions;  ///< Files of robot motions.
  std::string json;                  ///< Report to write; empty: none, `-`: standard output.
  std::vector<std::string> gates;    ///< Files, `KEY=NUMBER`, `KEY=none`, `none`.
};

/// `retarget convert`: robot motions from one format to another.
struct ConvertOptions {
  RunOptions run;  ///< Robot, rate and outputs.
  ReadingOptions reading;
  std::string input;
};

/// `retarget compare`: whether two motions agree.
struct CompareOptions {
  RunOptions run;  ///< Robot.
  ReadingOptions reading;
  std::string a, b;
  double tolerance = 1e-6;
};

/// `retarget verify`: whether a run still gives the same bytes.
struct VerifyOptions {
  CommonOptions common;
  std::string file;  ///< The sidecar.
};

/// `retarget inspect`: what a motion file holds.
struct InspectOptions {
  CommonOptions common;
  SourceOptions source;
  HumanOptions human;
  bool skeleton_only = false;
  bool json = false;
  std::string positions;  ///< CSV to write; empty: none.
};

/// What `retarget robots` does.
enum class RobotsAction : unsigned char { kList, kShow, kCheck, kAdd };

/// `retarget robots`: what robots there are, what is odd about them, new ones.
struct RobotsOptions {
  CommonOptions common;
  RobotsAction action = RobotsAction::kList;
  std::string robot;         ///< Name, folder, or (check) a model file; of a new robot its name.
  std::string model;         ///< Of a new robot: MJCF or URDF.
  std::string output = ".";  ///< Folder that a new robot's folder goes into.
  bool force = false;        ///< Replace a folder that is there.
  bool json = false;
};

}  // namespace retarget::cli
