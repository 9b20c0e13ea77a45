#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/pose.h"

struct mjModel_;

namespace RETARGET_API retarget {

class KinematicTree;
class Robot;

/// Ranges of a robot's joints under one name.
struct LimitSet {
  std::string name;           ///< `official`, `gmr`, `model`, or the file it came from.
  std::string source;         ///< Source of the values, human-readable; may be empty.
  std::vector<double> lower;  ///< Lower limits in the robot's joint order, rad or m; -infinity:
                              ///< none.
  std::vector<double> upper;  ///< Upper limits, likewise; +infinity: none. lower <= upper.
};

/// A limit set of the robot by name, or from a file: JSON `{"joint": [lower, upper], ...}` or the
/// joint ranges of an MJCF (extension .xml; with or without a free joint). Joints that a file does
/// not name keep the model's ranges; joints that the robot lacks are ignored in an MJCF and errors
/// in JSON. The range of a joint held by the robot's variant is its held position. An unknown name
/// lists the robot's sets; all errors in a file are reported at once (kConfig).
[[nodiscard]] Result<LimitSet> load_limits(const Robot& robot, const std::string& name_or_file);

struct ModelDeleter {
  void operator()(mjModel_* model) const;
};
/// A MuJoCo model with its owner.
using ModelPtr = std::unique_ptr<mjModel_, ModelDeleter>;

/// A body of the kinematic tree; indices are MuJoCo's (0 is the world).
struct RobotBody {
  std::string name;
  int parent = 0;
  Pose parent_from_body;  ///< Pose at the zero position of the body's joints; metres.
};

/// A hinge or slide joint: one degree of freedom.
struct RobotJoint {
  enum class Type { kHinge, kSlide };
  std::string name;
  Type type = Type::kHinge;
  int body = 0;                                      ///< The body that it moves.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< Unit vector in the body's frame.
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< Point on the axis in the body's frame,
                                                     ///< metres.
  double reference = 0.0;  ///< Joint position at which the body's pose is parent_from_body.
  int qpos_address = 0;    ///< Index into a configuration.
  int dof_address = 0;     ///< Index into a velocity.
};

/// The contact points of a foot.
struct Sole {
  std::string side;  ///< `left` or `right`.
  int body = 0;
  std::vector<Eigen::Vector3d> points;  ///< Points in the body's frame, metres.
  std::vector<std::string> labels;      ///< One per point; may be empty.
};

/// A primitive that represents a body, or part of it, in distance queries.
struct CollisionShape {
  enum class Type { kSphere, kCapsule, kBox };
  Type type = Type::kSphere;
  int body = 0;
  int geom = -1;             ///< The corresponding geom of the model; -1: none.
  Pose body_from_shape;      ///< The centre; a capsule's axis is z, a box's sides are the axes.
  double radius = 0.0;       ///< Sphere and capsule, metres.
  double half_length = 0.0;  ///< Capsule: from the centre to an end of the axis, without caps.
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  ///< Box, metres.
};

/// rad/s; for hinges without a published speed limit.
inline constexpr double kDefaultSpeedLimit = 20.0;
/// m/s; for slides without a published speed limit. The URDF of Fetch has 0.1 for the lift of the
/// trunk and 0.05 for the fingers.
inline constexpr double kDefaultSlideSpeedLimit = 1.0;

/// A robot with fewer joints, as sold by its maker or used by a training framework: some are
/// locked, or it has its own model without them.
struct RobotVariant {
  std::string name;
  std::string description;               ///< Human-readable; may be empty.
  std::map<std::string, double> locked;  ///< Missing joints and their held positions, rad or m.
  std::string model;  ///< Its own MJCF file; empty: the robot's model with locked joints.
  /// Bodies that occur in the variant's motion files although none of its joints moves them.
  std::vector<std::string> bodies;
  /// Points on joint axes of `model` between which limbs are measured, in the frame of the joint's
  /// body, metres. Default: the origin of the joint's body.
  std::map<std::string, Eigen::Vector3d> anchors;
};

/// A joint driven by another joint (the leader), such as a finger's outer joint driven by a linkage
/// or a tendon: position = ratio * leader + offset.
struct JointCoupling {
  std::string leader;  ///< The driving joint.
  double ratio = 1.0;
  double offset = 0.0;  ///< rad or m.
};

/// Data of a robot's profile (robot.json), in addition to its model; load_robot.h describes the
/// file.
struct RobotProfile {
  std::string name;
  std::string description, source, licence;  ///< Human-readable.
  std::string revision;       ///< Revision of the source, human-readable; empty: not recorded.
  std::string revision_date;  ///< Date of that revision, YYYY-MM-DD; empty: not recorded.
  std::vector<std::string> joint_order;  ///< Output columns; empty: the model's order.
  std::vector<LimitSet> limit_sets;
  std::string default_limits;                        ///< Name of a set; empty: the model's ranges.
  std::map<std::string, std::string> method_limits;  ///< Default set of a method.
  std::map<std::string, double> speed_limits;        ///< Limits by joint name, rad/s or m/s.
  std::string speed_limits_source;                   ///< Human-readable.
  double default_speed_limit = kDefaultSpeedLimit;  ///< Limit of hinges not in speed_limits, rad/s.
  std::map<std::string, double> torque_limits;      ///< Limits by joint name, N m or N.
  std::string torque_limits_source;                 ///< Human-readable.
  /// Rotor inertia reflected through the gear, by joint name, kg m^2 or kg.
  std::map<std::string, double> rotor_inertias;
  std::string rotor_inertias_source;  ///< Human-readable.
  /// Couplings by name of the driven joint. Only the hand solver uses them (docs/hands.md).
  std::map<std::string, JointCoupling> coupled_joints;
  std::map<std::string, double> t_pose;  ///< Non-zero joint positions of the T-pose, rad or m.
  std::vector<Sole> soles;
  std::string soles_source;      ///< Source of the soles, human-readable.
  bool soles_estimated = false;  ///< The soles are not measured: feet may float or sink.
  /// The base is fixed at its pose in the model: an upper body on a stand or a wheeled platform.
  /// The robot then has no soles, and follows the human relative to the human's hips or chest
  /// (docs/own_robot.md).
  bool fixed_base = false;
  std::vector<std::pair<int, int>> allowed_self_contact;  ///< Pairs of bodies.
  /// Auxiliary bodies that only carry a joint of their single child body. The child has several
  /// joints, or a joint with an anchor, but model readers expect one joint per body, at its origin.
  std::vector<std::string> joint_frames;
  std::vector<RobotVariant> variants;
};

/// A robot: MuJoCo model, kinematic tree and profile. Immutable, shared by all threads.
///
/// A configuration (qpos) is MuJoCo's: root position x y z (metres), root quaternion w x y z, then
/// the joint positions (rad, m), each at its qpos_address. A robot with a fixed base has the root
/// values too; they stay at its zero configuration.
class Robot {
 public:
  /// @param model  compiled model; its first joint is free, all others are hinges or slides.
  ///     load_robot checks this.
  /// @param warnings  warnings about the model.
  Robot(ModelPtr model, RobotProfile profile, std::vector<std::string> warnings = {});

  /// Replaces the profile, including the output order. Call before the robot is shared.
  void set_profile(RobotProfile profile);
  /// Locks the joints of a variant. They are removed from the output columns; their range in every
  /// limit set and their zero configuration become the locked position. Call once, before the robot
  /// is shared; robot_variant does it by name.
  void set_variant(const RobotVariant& variant);
  /// Makes this the model of a variant of `whole`. Call once, before the robot is shared.
  void set_whole(std::shared_ptr<const Robot> whole) { whole_ = std::move(whole); }

  /// Replaces the model's shapes. Call before the robot is shared.
  void set_collision_shapes(std::vector<CollisionShape> shapes) {
    collision_shapes_ = std::move(shapes);
  }

  [[nodiscard]] const mjModel_* model() const { return model_.get(); }
  [[nodiscard]] const std::string& name() const { return profile_.name; }
  [[nodiscard]] bool fixed_base() const { return profile_.fixed_base; }
  [[nodiscard]] const RobotProfile& profile() const { return profile_; }
  /// MuJoCo's warnings about the model, one line each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// The variant of this robot; empty name: the whole robot.
  [[nodiscard]] const RobotVariant& variant() const { return variant_; }
  /// The complete robot, if this is a variant with its own model; else null. Joints and bodies of
  /// the two correspond by name.
  [[nodiscard]] const std::shared_ptr<const Robot>& whole() const { return whole_; }
  [[nodiscard]] const std::vector<RobotBody>& bodies() const { return bodies_; }
  /// All joints except the free joint, in the model's order.
  [[nodiscard]] const std::vector<RobotJoint>& joints() const { return joints_; }
  /// Kinematic tree used for computations; bodies fixed to each other are merged into one link.
  [[nodiscard]] const KinematicTree& tree() const { return *tree_; }
  /// Indices into joints() in the order of the output columns.
  [[nodiscard]] const std::vector<int>& output_joints() const { return output_joints_; }
  /// The spheres, capsules and boxes among the geoms of the robot that take part in contacts, in
  /// the model's order, or their replacements. Other shapes, and shapes fixed to the world, are
  /// omitted.
  [[nodiscard]] const std::vector<CollisionShape>& collision_shapes() const {
    return collision_shapes_;
  }
  /// The body of the free joint.
  [[nodiscard]] int root_body() const { return root_body_; }
  [[nodiscard]] int configuration_size() const;
  /// The model's qpos0; joints held by the variant are at their held position.
  [[nodiscard]] std::vector<double> zero_configuration() const;
  /// The joint ranges of the model, as a limit set called `model`.
  [[nodiscard]] const LimitSet& model_limits() const { return model_limits_; }
  /// Name of a method's default limit set.
  [[nodiscard]] std::string limits_for(const std::string& method) const;
  /// Speed limit of a joint, rad/s or m/s: from the profile, else the profile's default for hinges
  /// and kDefaultSlideSpeedLimit for slides.
  /// @param joint  index into joints().
  [[nodiscard]] double speed_limit(int joint) const;
  /// Torque limit of a hinge, N m, or force limit of a slide, N: from the profile, else from the
  /// model (`actuatorfrcrange`), else infinity.
  /// @param joint  index into joints().
  [[nodiscard]] double torque_limit(int joint) const;
  /// Reflected rotor inertia of a joint, kg m^2 or kg: from the profile, else from the model
  /// (`armature`, 0 by default).
  /// @param joint  index into joints().
  [[nodiscard]] double rotor_inertia(int joint) const;

  /// The body moved by the joints of a body: the body itself, or the first body below it that is
  /// not one of the profile's joint_frames.
  [[nodiscard]] int moved_body(int body) const;

  /// Index of a body or joint by name. An empty name is never found, even if the model has unnamed
  /// elements.
  [[nodiscard]] std::optional<int> find_body(std::string_view name) const;
  [[nodiscard]] std::optional<int> find_joint(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> body_names() const;
  [[nodiscard]] std::vector<std::string> joint_names() const;

 private:
  void read_bodies();
  void read_joints();
  void read_collision_shapes();

  ModelPtr model_;
  RobotProfile profile_;
  RobotVariant variant_;
  std::shared_ptr<const Robot> whole_;
  std::vector<std::string> warnings_;
  std::vector<RobotBody> bodies_;
  std::vector<RobotJoint> joints_;
  std::shared_ptr<const KinematicTree> tree_;
  std::vector<int> output_joints_;
  std::vector<CollisionShape> collision_shapes_;
  int root_body_ = 0;
  LimitSet model_limits_;
};

/// Returns a variant of a robot by its name in the profile.
///
/// A variant without its own model is the robot with some joints locked (Robot::set_variant):
/// solvers keep these exactly at their locked positions, regardless of the model's qpos0. A variant
/// with a model is another Robot loaded from it, with the profile restricted to the bodies and
/// joints that both have; Robot::whole() is the robot with all joints.
///
/// @param name  a variant, or the number of the robot's columns, which selects the robot unchanged.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all; a model that cannot be
///   read, has another root, or whose joints are not the robot's without the locked ones.
[[nodiscard]] Result<std::shared_ptr<const Robot>> robot_variant(
    const std::shared_ptr<const Robot>& robot, const std::string& name);

/// Computes the world poses of all bodies in a configuration, by body index, in metres. It needs no
/// mjData and allocates no memory.
/// @param qpos  configuration_size() values; the root quaternion need not have unit norm, but must
///     not be zero.
/// @param world_from_body  output; bodies().size() poses.
void forward_kinematics(const Robot& robot, std::span<const double> qpos,
                        std::span<Pose> world_from_body);

}  // namespace retarget
