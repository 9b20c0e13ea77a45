#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Point of application of a contact force in a frame.
struct FitContactPlace : ContactPlace {
  int foot = -1;  ///< Index into FitModel::feet; -1: other links, or on a body of the scene.
  /// Displacements to the nearest points at which the ankle torque is within its limit (to_limit)
  /// and within the share of it that the fit plans with (to_reach); world axes, metres.
  Eigen::Vector3d to_limit = Eigen::Vector3d::Zero(), to_reach = to_limit;
};

/// The robot's points that may transmit contact forces in the frames of a window: points of planned
/// feet, and slow points near the floor or near a body of the scene. Frames are relative to the
/// window's first frame.
class WindowContacts {
 public:
  /// The robot in a frame.
  struct Robot {
    const TreeState& pose;
    const InverseDynamics& inverse;  ///< Computed for this frame.
    Eigen::Vector3d heading;         ///< Forward direction of the base, world.
    double supported;  ///< Vertical force that the surroundings must exert, share of the weight.
  };

  WindowContacts(const FitModel& model, const FitOptions& options, const FitWindow& window,
                 const FitClip& clip);

  /// The bodies of the scene that the robot carries in a frame. Valid until the next call.
  [[nodiscard]] std::span<const LinkLoad> loads(int t, const TreeState& pose);
  /// Finds the contacts of a frame.
  void find(int t, const FitClip& clip, const Robot& robot);
  /// Computes the contact positions of a frame.
  void place(int t, const TreeState& pose);
  /// Gives a frame without contacts those of the nearest frame at most `reach` frames away, because
  /// contacts begin and end between frames. The metric `unexplained` does the same.
  void lend(int reach);

  [[nodiscard]] std::vector<FitContactPlace>& places(int t) { return frames_[index(t)].places; }
  [[nodiscard]] const std::vector<FitContactPlace>& places(int t) const {
    return frames_[index(t)].places;
  }

 private:
  // A point of the robot on which a surface may exert a contact force.
  struct Contact {
    SupportPoint point;
    std::optional<std::size_t> body;  // Index of the scene's body; empty: the floor.
    int foot = -1;  // Index into FitModel::feet; -1: other links, or on a body of the scene.
  };
  struct Frame {
    std::vector<Contact> contacts;
    std::vector<FitContactPlace> places;
  };
  // Limits for the distance from a surface, metres, and for the speed relative to it, m/s.
  struct Near {
    double height, speed;
  };

  static std::size_t index(int t) { return static_cast<std::size_t>(t); }
  void shrink_soles(double share);
  void list_points();
  [[nodiscard]] ContactPlace place_of(int t, const Contact& contact, const TreeState& pose) const;
  [[nodiscard]] static bool touches(const SupportPoint& point, const Robot& robot, Near near);
  void add_feet(int t, const FitClip& clip, const Robot& robot, Near near,
                std::vector<Contact>& contacts) const;
  void add_links(const Robot& robot, Near near, std::vector<Contact>& contacts) const;
  void add_touched_bodies(int t, const Robot& robot, Near near,
                          std::vector<Contact>& contacts) const;
  void keep_outermost_contacts(int t, const Robot& robot, std::vector<Contact>& contacts);

  const FitModel& model_;
  const FitWindow& window_;
  std::vector<Frame> frames_;
  std::optional<SceneSupports> scene_;
  std::vector<SupportPoint> points_;  // Points that may touch bodies of the scene.
  std::vector<LinkLoad> loads_;
  // Contact points of the shrunk soles, by foot and end, in the frame of the foot's link.
  std::vector<std::array<std::vector<Eigen::Vector3d>, 2>> sole_contacts_;
  std::vector<Eigen::Vector3d> outermost_;
  std::vector<int> chosen_;
};

}  // namespace retarget
