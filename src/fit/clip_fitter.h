#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fit/fit_model.h"
#include "fit/foot_plan.h"
#include "fit/frame_terms.h"
#include "retarget/options.h"
#include "retarget/report.h"

namespace retarget {

/// A clip on its way through a fit.
struct FitClip {
  double frame_time = 1.0 / 30.0;
  int frame_count = 0;
  std::vector<TaskTarget> targets;  ///< Frame-major, one per task of the model.
  FootPlan feet;
  std::vector<Eigen::Vector2d> anchors;  ///< By contact phase.
  std::vector<double> qpos;              ///< Frame-major, as RobotClip's.

  [[nodiscard]] std::span<double> frame(int t, int size) {
    return {qpos.data() + static_cast<std::size_t>(t) * static_cast<std::size_t>(size),
            static_cast<std::size_t>(size)};
  }
  [[nodiscard]] std::span<const double> frame(int t, int size) const {
    return {qpos.data() + static_cast<std::size_t>(t) * static_cast<std::size_t>(size),
            static_cast<std::size_t>(size)};
  }
  [[nodiscard]] FrameGoals goals(int t, std::size_t tasks) const {
    return {{targets.data() + static_cast<std::size_t>(t) * tasks, tasks},
            feet.ends_of(t),
            feet.upright_of(t),
            anchors,
            1.0,
            feet.supports_of(t)};
  }
};

/// Frames that are solved together.
struct FitWindow {
  int begin = 0, end = 0;   ///< Frames [begin, end).
  bool fixed_ends = false;  ///< The frames before and after stay as they are and count.
  int context = 0;          ///< How many fixed frames on either side count for smoothing.
};

/// Refines some frames of a clip by damped Gauss-Newton steps over all of them (docs/fit.md).
///
/// Reads no frame outside the window but those near fixed ends, and writes only the window's
/// frames and the anchors of phases that lie in it: windows that are apart may run at the same time.
/// @param keep_going  asked before every step; false stops.
/// @return how it ended; without costs.
FitStatus fit_window(const FitModel& model, const FitOptions& options, const FitWindow& window,
                     FitClip& clip, const std::function<bool()>& keep_going);

/// The same steps on a window that moves along a clip while the clip grows at its end: what is known
/// of frames from earlier steps stays with them. Allocates nothing once vectors have their size.
class MovingFit {
 public:
  virtual ~MovingFit() = default;
  /// The window is frames [begin, clip.frame_count) from now on; those before stay as they are and
  /// count. Call it whenever the clip or its contact phases changed.
  /// @param forgotten  frames that the clip has lost at its beginning.
  virtual void move(int begin, int forgotten) = 0;
  /// One step over the window. Contacts that lie in it are placed anew after it; each frame comes to
  /// hold its feet as hard as fit_window's last steps do.
  virtual void step() = 0;
};
[[nodiscard]] std::unique_ptr<MovingFit> make_moving_fit(const FitModel& model,
                                                         const FitOptions& options, FitClip& clip,
                                                         int context);

/// The change from one configuration to the next by degree of freedom: metres, the rotation vector
/// in the root's axes, joints.
void configuration_step(const FitModel& model, std::span<const double> from,
                        std::span<const double> to, double* step);

}  // namespace retarget
