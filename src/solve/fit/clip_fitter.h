#pragma once

#include <functional>
#include <memory>
#include <span>

#include "retarget/options.h"
#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Refines a window of a clip by damped Gauss-Newton steps over all of its frames (docs/fit.md).
///
/// Outside the window, it reads only the context frames next to fixed ends. It writes only the
/// window's frames and the anchors of the contact phases inside the window. Windows can therefore
/// run concurrently if neither reads frames of the other.
/// @param keep_going  called before every step; returning false stops the fit.
/// @return the final status, without costs.
FitStatus fit_window(const FitModel& model, const FitOptions& options, const FitWindow& window,
                     FitClip& clip, const std::function<bool()>& keep_going);

/// Takes the same steps on a window that slides along a growing clip. Frames keep their damping,
/// active bounds and near pairs from step to step. Does not allocate once its vectors have reached
/// their size.
class MovingFit {
 public:
  virtual ~MovingFit() = default;
  /// Sets the window to frames [begin, clip.frame_count). Earlier frames stay fixed, but still
  /// enter the cost. Call it whenever the clip or its contact phases have changed.
  /// @param forgotten  number of frames that were dropped from the beginning of the clip.
  virtual void move(int begin, int forgotten) = 0;
  /// Takes one step over the window, then updates the anchors of the contact phases inside it. The
  /// weight of a frame's anchors grows with its number of steps, up to the weight of the last steps
  /// of fit_window().
  /// @return false if a value is not finite; all frames are then unchanged.
  [[nodiscard]] virtual bool step() = 0;
};
/// Makes a moving fit with an empty window. Keeps references to the model, options and clip.
/// @param context  number of fixed frames before the window that are used for smoothing.
[[nodiscard]] std::unique_ptr<MovingFit> make_moving_fit(const FitModel& model,
                                                         const FitOptions& options, FitClip& clip,
                                                         int context);

}  // namespace retarget
