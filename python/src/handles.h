#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/measure_files.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/solve.h"

// Contents of Python objects: const values of the library, shared with the arrays made from them.

namespace retarget::python {

/// World poses of all joints, frame-major, in the file's units and axes.
struct WorldPoses {
  std::vector<double> positions;  ///< Frames x joints x 3.
  std::vector<double> rotations;  ///< Frames x joints x 4, wxyz.
};

/// Implementation of retarget.Clip.
class ClipHandle {
 public:
  explicit ClipHandle(Clip clip) : clip_(std::make_shared<const Clip>(std::move(clip))) {}
  explicit ClipHandle(std::shared_ptr<const Clip> clip) : clip_(std::move(clip)) {}

  [[nodiscard]] const Clip& operator*() const { return *clip_; }
  [[nodiscard]] const Clip* operator->() const { return clip_.get(); }
  [[nodiscard]] const std::shared_ptr<const Clip>& shared() const { return clip_; }
  /// Computed on first use; callable from any thread, without the GIL.
  [[nodiscard]] std::shared_ptr<const WorldPoses> world() const;
  /// Marks the result of an edit, which keeps the name of the file but not its content.
  [[nodiscard]] ClipHandle as_edited() && {
    is_edited_ = true;
    return std::move(*this);
  }
  [[nodiscard]] bool is_edited() const { return is_edited_; }

 private:
  struct World {
    std::mutex mutex;
    std::shared_ptr<const WorldPoses> poses;
  };
  std::shared_ptr<const Clip> clip_;
  std::shared_ptr<World> world_ = std::make_shared<World>();
  bool is_edited_ = false;
};

/// Implementation of retarget.Robot.
struct RobotHandle {
  LoadedRobot loaded;
  std::string hash = {};  ///< model_hash() when it was loaded.

  [[nodiscard]] const Robot& operator*() const { return *loaded.robot; }
  [[nodiscard]] const Robot* operator->() const { return loaded.robot.get(); }
};

/// Implementation of retarget.Plan.
struct PlanHandle {
  std::shared_ptr<const Plan> plan;
  RobotHandle robot;
  std::shared_ptr<const Clip> clip;  ///< As given; that of `plan` is cleaned and scaled.
};

/// Implementation of retarget.Motion: solved here, read from a file, or made from arrays.
struct MotionHandle {
  std::shared_ptr<const Motion> solved;   ///< Null if the motion was not solved here.
  std::shared_ptr<const RobotClip> clip;  ///< Clip of `solved`, if any.
  RobotHandle robot;
  std::shared_ptr<const Clip> made_from;  ///< Source clip of `solved`; pickles need it.
  std::string name;                       ///< Name of its file, or of its source clip.
  std::string summary;                    ///< Human-readable, line by line.
  SaveOptions save = {};                  ///< Defaults of save() and tracking().
  /// Contacts of a motion that was not solved here; empty: unknown.
  std::optional<FootContacts> contacts = std::nullopt;
  bool rate_known = true;  ///< False: the rate of a file without one is a default.
  /// The run of a motion that was not solved here; null: unknown.
  std::shared_ptr<const RecordedRun> recorded = nullptr;
  /// True: `recorded` is from a sidecar, of which evaluate() uses as much as the command does.
  /// False: `recorded` is a run of Python, all of whose options evaluate() uses.
  bool is_of_file = true;
  /// Time of the first frame in the motion of which this one is a part, seconds; empty: not a part.
  std::optional<double> part_start = std::nullopt;
};

/// The run that made a motion; null: unknown.
[[nodiscard]] std::shared_ptr<const RecordedRun> run_of(const MotionHandle& motion);
/// The record of a motion for measuring it against a source.
[[nodiscard]] RecordedMotion record_of(const MotionHandle& motion);
/// The record for a given clip. A sidecar's part and mirroring do not apply to an edited clip;
/// warns of them.
[[nodiscard]] RecordedMotion record_against(const MotionHandle& motion, const ClipHandle& clip,
                                            Observer& observer);
/// Options for measuring a motion at its rate: those of a run of this process, otherwise defaults.
[[nodiscard]] Options measuring_options(const MotionHandle& motion);

/// Contacts of the feet per frame: those of the fit, or those given; empty: unknown.
[[nodiscard]] std::optional<FootContacts> foot_contacts(const MotionHandle& motion);

/// Hashes the files of a robot's model: the model with its includes, the profile, the models of
/// variants. Empty if one of them cannot be read any more.
[[nodiscard]] std::string model_hash(const LoadedRobot& robot);

/// Finds the folder with robots/ and configs/: the given one, $RETARGET_DATA_DIR, or the package's.
/// Errors: those of find_data_folder.
[[nodiscard]] Result<std::string> data_folder_of(const std::string& chosen);

}  // namespace retarget::python
