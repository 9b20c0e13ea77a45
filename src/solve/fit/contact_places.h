#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Computes the anchors of a window's contact phases: the mean position of the foot end or body
/// over the frames of the contact. Writes only the anchors of phases that lie inside the window.
class ContactPlaces {
 public:
  ContactPlaces(const FitModel& model, FitClip& clip)
      : model_(model), clip_(clip), pose_(model.tree) {
    resize();
  }

  /// Resets all pushes. Call it after the contacts of the clip have changed.
  void resize();
  /// Sets the anchors of the window's contacts from its current frames, and adds the pushes since
  /// the last call.
  void place(const FitWindow& window);
  /// Pushes the anchors of two overlapping feet apart. The mean positions separate too slowly,
  /// because they also average frames in which only one foot is in contact.
  void push_apart(const FitWindow& window, int frame, const FootOverlap& overlap);

  /// Displacements that the next place() adds, by contact phase; world x and y, metres. They are
  /// the only state between calls.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& pushes() const { return pushes_; }
  void set_pushes(const std::vector<Eigen::Vector2d>& pushes) { pushes_ = pushes; }

 private:
  [[nodiscard]] int last_link(const FitWindow& window) const;

  const FitModel& model_;
  FitClip& clip_;
  TreeState pose_;
  std::vector<Eigen::Vector2d> sums_, pushes_;
  std::vector<int> counts_;
};

}  // namespace retarget
