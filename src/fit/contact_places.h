#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "fit/frame_terms.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// Where the contacts of a window stand: each where its end of a foot, or its body, is on average over its
/// frames. Writes the anchors of contacts that lie in the window, and no others.
class ContactPlaces {
 public:
  ContactPlaces(const FitModel& model, FitClip& clip)
      : model_(model), clip_(clip), pose_(model.tree) {
    resize();
  }

  /// The clip's contacts have changed: nothing is pushed.
  void resize();
  /// Places those of a window, by its frames as they are, apart as they were pushed since the last call.
  void place(const FitWindow& window);
  /// Two feet that stand in each other have places in each other: their means alone would come apart
  /// too slowly, for the frames in which one foot stands alone hold it back.
  void push_apart(const FitWindow& window, int frame, const FootOverlap& overlap);

  /// Pushes for the next place(), metres by contact: all that a call leaves for the next.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& pushes() const { return pushes_; }
  void set_pushes(const std::vector<Eigen::Vector2d>& pushes) { pushes_ = pushes; }

 private:
  const FitModel& model_;
  FitClip& clip_;
  TreeState pose_;
  std::vector<Eigen::Vector2d> sums_, pushes_;
  std::vector<int> counts_;
};

}  // namespace retarget
