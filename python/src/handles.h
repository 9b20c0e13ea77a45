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

// What Python's objects hold: const values of the library, shared with the arrays made from them.

namespace retarget::python {

/// World poses of all joints, frame by frame, file units and axes.
struct WorldPoses {
  std::vector<double> positions;  ///< frames x joints x 3
  std::vector<double> rotations;  ///< frames x joints x 4, wxyz
};

/// retarget.Clip
class ClipHandle {
 public:
  explicit ClipHandle(Clip clip) : clip_(std::make_shared<const Clip>(std::move(clip))) {}
  explicit ClipHandle(std::shared_ptr<const Clip> clip) : clip_(std::move(clip)) {}

  [[nodiscard]] const Clip& operator*() const { return *clip_; }
  [[nodiscard]] const Clip* operator->() const { return clip_.get(); }
  [[nodiscard]] const std::shared_ptr<const Clip>& shared() const { return clip_; }
  /// Made when they are first asked for; by any thread, without the GIL.
  [[nodiscard]] std::shared_ptr<const WorldPoses> world() const;

 private:
  struct World {
    std::mutex mutex;
    std::shared_ptr<const WorldPoses> poses;
  };
  std::shared_ptr<const Clip> clip_;
  std::shared_ptr<World> world_ = std::make_shared<World>();
};

/// retarget.Robot
struct RobotHandle {
  LoadedRobot loaded;

  [[nodiscard]] const Robot& operator*() const { return *loaded.robot; }
  [[nodiscard]] const Robot* operator->() const { return loaded.robot.get(); }
};

/// retarget.Motion: solved here, or read from a file.
struct MotionHandle {
  std::shared_ptr<const Motion> solved;   ///< Null: it was read.
  std::shared_ptr<const RobotClip> clip;  ///< Of `solved` where there is one.
  RobotHandle robot;
  std::weak_ptr<const Clip> made_from;  ///< Of `solved`.
  std::string name;                     ///< Of its file, or of the clip it was made from.
  std::string summary;                  ///< For people, line by line.
};

/// The folder with robots/ and configs/: the given one, $RETARGET_DATA_DIR, that of the package.
/// Errors: find_data_folder's.
[[nodiscard]] Result<std::string> data_folder_of(const std::string& chosen);

}  // namespace retarget::python
