#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dynamics/centroidal_map.h"
#include "dynamics/centroidal_step.h"
#include "dynamics/inverse_dynamics.h"
#include "dynamics/motion_spline.h"
#include "dynamics/support_points.h"
#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "retarget/options.h"

namespace retarget {

/// What a fit's last steps do about the forces of a movement: where its contacts cannot supply them,
/// the centre of mass and the angular momentum are moved as little as it takes (CentroidalStep), and
/// six rows a frame ask the robot to follow (docs/dynamics.md). Of one window.
class FitDynamics {
 public:
  FitDynamics(const FitModel& model, const FitOptions& options, const FitWindow& window,
              const FitClip& clip);

  /// Whether the robot has a mass and the source contacts.
  [[nodiscard]] static bool possible(const FitModel& model) {
    return model.inertias.mass > 0.0 && !model.feet.empty();
  }

  /// Finds contacts, and where these are to be trusted. Before all else.
  /// @return measure(clip)
  double begin(const FitClip& clip);
  /// What contacts cannot supply of what the clip needs as it is now, in weights: mean over the
  /// frames, each at most 1 and as far as its contacts are trusted.
  double measure(const FitClip& clip);
  /// Frames that stay as they are: their contacts are not known.
  [[nodiscard]] int distrusted_frames() const;
  /// Finds how the clip, as it is now, should change. Before each step that looks at it.
  void plan(const FitClip& clip);
  /// Adds the rows of a frame to a step's system.
  /// @param gradient, hessian  as FrameTerms::assemble's.
  /// @return what the rows cost.
  double add_rows(int frame, const TreeState& pose, double* gradient, double* hessian, int stride);
  /// The frame was moved so far, by degree of freedom.
  void moved(int frame, std::span<const double> step);

 private:
  void read_frames(const FitClip& clip);
  [[nodiscard]] double missing_share() const;
  [[nodiscard]] int frames_within(double seconds) const;
  void read_frame(const MotionState& state, int t, const FitClip& clip);
  void find_contacts(int t, const FitClip& clip, std::vector<SupportPoint>& contacts);
  void add_feet(int t, const FitClip& clip, double height, double speed,
                std::vector<SupportPoint>& contacts) const;
  void add_bodies(double height, double speed, std::vector<SupportPoint>& contacts) const;
  [[nodiscard]] bool touches(const SupportPoint& point, double height, double speed) const;
  void lend_contacts();
  void fill_cone(int t);
  void find_trust();
  void restrain(std::vector<Vector6d>& moves);

  const FitModel& model_;
  const FitOptions& options_;
  const FitWindow& window_;
  int count_;  // frames of the window
  CentroidalScale scale_;
  InverseDynamics inverse_;
  CentroidalMap map_;
  TreeState pose_;
  CentroidalStep step_;
  std::vector<CentroidalFrame> frames_;
  std::vector<std::vector<SupportPoint>> contacts_;
  std::vector<std::vector<Eigen::Vector3d>> contact_places_;
  std::vector<Eigen::Vector3d> com_, first_com_;
  std::vector<Vector6d> goals_;  // centre of mass, world; turn still to be made
  std::vector<double> rest_before_, share_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> spin_rows_;  // of all frames side by side
  bool begun_ = false, planned_ = false;
  std::vector<Eigen::Vector3d> places_;
  std::vector<int> chosen_;
};

}  // namespace retarget
