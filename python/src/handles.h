#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/motion.h"
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

 private:
  struct World {
    std::mutex mutex;
    std::shared_ptr<const WorldPoses> poses;
  };
  std::shared_ptr<const Clip> clip_;
  std::shared_ptr<World> world_ = std::make_shared<World>();
};

/// Implementation of retarget.Robot.
struct RobotHandle {
  LoadedRobot loaded;

  [[nodiscard]] const Robot& operator*() const { return *loaded.robot; }
  [[nodiscard]] const Robot* operator->() const { return loaded.robot.get(); }
};

/// Implementation of retarget.Motion: solved here, or read from a file.
struct MotionHandle {
  std::shared_ptr<const Motion> solved;   ///< Null if the motion was read from a file.
  std::shared_ptr<const RobotClip> clip;  ///< Clip of `solved`, if any.
  RobotHandle robot;
  std::weak_ptr<const Clip> made_from;  ///< Source clip of `solved`.
  std::string name;                     ///< Name of its file, or of its source clip.
  std::string summary;                  ///< Human-readable, line by line.
};

/// Finds the folder with robots/ and configs/: the given one, $RETARGET_DATA_DIR, or the package's.
/// Errors: those of find_data_folder.
[[nodiscard]] Result<std::string> data_folder_of(const std::string& chosen);

}  // namespace retarget::python
