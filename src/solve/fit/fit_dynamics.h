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

/// A point of the robot that a surface may push.
struct FitContact {
  SupportPoint point;
  std::optional<std::size_t> body;  ///< Of the scene; empty: the floor.
  int foot = -1;                    ///< Index into FitModel::feet; -1: not a planned sole.
};

/// Where a surface pushes a contact.
struct FitContactPlace : ContactPlace {
  int foot = -1;  ///< Index into FitModel::feet; -1: not a planned sole.
  /// From the point to the nearest one where the ankle needs no more than its limit, and no more than
  /// the fit plans with; world axes, metres.
  Eigen::Vector3d to_limit = Eigen::Vector3d::Zero(), to_reach = to_limit;
};

/// The dynamics part of a fit's last steps, for one window. Where the contacts cannot supply the
/// forces of the movement, it moves the centre of mass and the angular momentum as little as
/// necessary (CentroidalStep) and adds six rows per frame that make the robot follow
/// (docs/dynamics.md).
class FitDynamics {
 public:
  FitDynamics(const FitModel& model, const FitOptions& options, const FitWindow& window,
              const FitClip& clip);

  /// Whether the model has mass and feet.
  [[nodiscard]] static bool possible(const FitModel& model) {
    return model.inertias.mass > 0.0 && !model.feet.empty();
  }

  /// Finds the contacts and how far they can be trusted. Call it first.
  /// @return measure(clip); NaN if the movement is too large to compute with.
  double begin(const FitClip& clip);
  /// Whether the contacts cannot supply the forces of some frame. Call it after begin().
  [[nodiscard]] bool is_needed() const;
  /// Mean over the frames of the wrench that the contacts cannot supply for the current clip, in
  /// body weights. Each frame counts at most 1, scaled by the trust in its contacts.
  double measure(const FitClip& clip);
  /// Number of frames that stay unchanged because their contacts are unknown.
  [[nodiscard]] int distrusted_frames() const;
  /// Computes how the current clip should change. Call it before each step that uses dynamics.
  /// @return false if a value is not finite.
  [[nodiscard]] bool plan(const FitClip& clip);
  /// Adds the rows of a frame to the system of a step.
  /// @param gradient, hessian  as in FrameTerms::assemble.
  /// @return the cost of the rows.
  double add_rows(int frame, const TreeState& pose, double* gradient, double* hessian, int stride);
  /// Reports the change that a step applied to a frame, by degree of freedom.
  void moved(int frame, std::span<const double> step);

 private:
  // By foot and end, in the frame of the foot's link.
  using SolePoints = std::vector<std::array<std::vector<Eigen::Vector3d>, 2>>;

  void read_frames(const FitClip& clip);
  [[nodiscard]] double missing_share() const;
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
  std::optional<SceneSupports> scene_;
  SolePoints sole_contacts_;                   // Points of the soles that may bear the robot.
  std::vector<Eigen::Vector3d> sole_normals_;  // By foot, in the axes of its link.
  // By link, N m: torque that the fit plans with where ankles are overloaded.
  std::vector<double> ankle_torques_;
  ConeProjector projector_;
  std::vector<double> overload_;      // By frame, 0 to 1: how much ankles limit the pressure.
  std::vector<SupportPoint> points_;  // That may touch bodies of the scene.
  std::vector<LinkLoad> loads_;
  std::vector<Eigen::Vector3d> com_, first_com_;
  std::vector<Vector6d> goals_;  // Centre of mass, world, metres; rotation still to be made.
  std::vector<double> rest_before_, share_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> spin_rows_;  // All frames side by side.
  bool begun_ = false, planned_ = false;
  std::vector<Eigen::Vector3d> places_;
  std::vector<int> chosen_;
};

}  // namespace retarget
