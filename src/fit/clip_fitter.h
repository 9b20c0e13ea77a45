#pragma once

#include <functional>
#include <memory>
#include <span>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "retarget/options.h"
#include "retarget/report.h"

namespace retarget {

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

}  // namespace retarget
