#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "solve/dynamics/centroidal_map.h"
#include "solve/dynamics/centroidal_step.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/motion_spline.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// A point of the robot on which a surface may exert a contact force.
struct FitContact {
  SupportPoint point;
  std::optional<std::size_t> body;  ///< Index of the scene's body; empty: the floor.
  int foot = -1;  ///< Index into FitModel::feet; -1: other links, or on a body of the scene.
};

/// Point of application of a contact force in a frame.
struct FitContactPlace : ContactPlace {
  int foot = -1;  ///< Index into FitModel::feet; -1: other links, or on a body of the scene.
  /// Displacements to the nearest points at which the ankle torque is within its limit (to_limit)
  /// and within the share of it that the fit plans with (to_reach); world axes, metres.
  Eigen::Vector3d to_limit = Eigen::Vector3d::Zero(), to_reach = to_limit;
};

/// The dynamics terms in the last steps of a fit, for one window. Where the contacts cannot supply
/// the required forces, it changes the paths of the centre of mass and of the angular
/// quasi-coordinate as little as necessary (CentroidalStep). Six rows per frame make the robot
/// follow these paths (docs/dynamics.md).
class FitDynamics {
 public:
  FitDynamics(const FitModel& model, const FitOptions& options, const FitWindow& window,
              const FitClip& clip);

  /// Whether the model has mass and feet.
  [[nodiscard]] static bool possible(const FitModel& model) {
    return model.inertias.mass > 0.0 && !model.feet.empty();
  }

  /// Detects the contacts of the clip and estimates how far they explain its forces (trust). Call
  /// it first.
  /// @return measure(clip); NaN if values are too large for the computation.
  double begin(const FitClip& clip);
  /// Whether there is a frame in which the contacts cannot supply the required forces. Call it
  /// after begin().
  [[nodiscard]] bool is_needed() const;
  /// Mean over the frames of the unexplained wrench of the current clip, in body weights. The value
  /// of a frame is at most 1 and is scaled by the trust in its contacts.
  double measure(const FitClip& clip);
  /// Whether to keep the steps after which measure() returned `now`, from `before`. The goals of the
  /// dynamics terms are wrong where unknown supports, such as uneven ground, carry the body: in more
  /// than 55 % of the frames, contacts are unknown or the unexplained wrench is above 10 % of the
  /// weight.
  [[nodiscard]] bool has_helped(double before, double now) const;
  /// Number of frames without trust: their contacts are unknown, so the dynamics terms are off.
  [[nodiscard]] int distrusted_frames() const;
  /// Computes the goals of the rows from the current clip. Call it before each step that uses
  /// dynamics.
  /// @return false if a value is not finite.
  [[nodiscard]] bool plan(const FitClip& clip);
  /// Adds the rows of a frame to the linear system of a step.
  /// @param gradient, hessian  see FrameTerms::assemble.
  /// @return the cost of the rows.
  double add_rows(int frame, const TreeState& pose, double* gradient, double* hessian, int stride);
  /// Updates the angular quasi-coordinate after a step.
  /// @param step  the change that the step applied to the frame, by degree of freedom.
  void moved(int frame, std::span<const double> step);

 private:
  // By foot and end, in the frame of the foot's link.
  using SolePoints = std::vector<std::array<std::vector<Eigen::Vector3d>, 2>>;

  void read_frames(const FitClip& clip);
  [[nodiscard]] double missing_share() const;
  [[nodiscard]] bool is_mostly_unexplained() const;
  [[nodiscard]] int frames_within(double seconds) const;
  void read_frame(const MotionState& state, int t, const FitClip& clip);
  void find_contacts(int t, const FitClip& clip, std::vector<FitContact>& contacts);
  void keep_outermost_contacts(int t, std::vector<FitContact>& contacts);
  void add_feet(int t, const FitClip& clip, double height, double speed,
                std::vector<FitContact>& contacts) const;
  void add_bodies(double height, double speed, std::vector<FitContact>& contacts) const;
  void add_touched_bodies(int t, double height, double speed,
                          std::vector<FitContact>& contacts) const;
  [[nodiscard]] bool touches(const SupportPoint& point, double height, double speed) const;
  [[nodiscard]] ContactPlace place_of(int t, const FitContact& contact) const;
  void lend_contacts();
  void shrink_soles();
  [[nodiscard]] double beyond_ankles(int t);
  void find_overloaded_ankles();
  void find_reach(int t);
  [[nodiscard]] double load_on(int t, int foot) const;
  void fill_cone(int t, Eigen::Vector3d FitContactPlace::*towards, double share);
  void find_trust();
  void restrain(std::vector<Vector6d>& moves);

  const FitModel& model_;
  const FitOptions& options_;
  const FitWindow& window_;
  int count_;  // Number of frames in the window.
  CentroidalScale scale_;
  InverseDynamics inverse_;
  CentroidalMap map_;
  TreeState pose_;
  CentroidalStep step_;
  std::vector<CentroidalFrame> frames_;
  std::vector<std::vector<FitContact>> contacts_;
  std::vector<std::vector<FitContactPlace>> contact_places_;
  std::vector<Eigen::Vector3d> headings_;  // Forward direction of the base, by frame.
  std::optional<SceneSupports> scene_;
  SolePoints sole_contacts_;                   // Contact points of the shrunk soles.
  std::vector<Eigen::Vector3d> sole_normals_;  // One per foot, in the axes of its link.
  // By link, N m: largest torque in frames with overloaded ankles.
  std::vector<double> ankle_torques_;
  ConeProjector projector_;
  std::vector<double> overload_;      // One per frame, 0 to 1: share of to_reach that applies.
  std::vector<SupportPoint> points_;  // Points that may touch bodies of the scene.
  std::vector<LinkLoad> loads_;       // Lifted objects, in the current frame.
  std::vector<Eigen::Vector3d> com_, first_com_;  // Now and in begin(); world, metres.
  // Goal of the centre of mass (world, metres) and remaining change of the angular
  // quasi-coordinate.
  std::vector<Vector6d> goals_;
  std::vector<double> rest_before_, share_;             // One per frame; see restrain().
  Eigen::Matrix<double, 3, Eigen::Dynamic> spin_rows_;  // Angular rows, frame after frame.
  bool begun_ = false, planned_ = false;
  std::vector<Eigen::Vector3d> places_;
  std::vector<int> chosen_;
};

}  // namespace retarget
