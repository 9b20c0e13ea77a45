#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/pose.h"
#include "retarget/triangle_mesh.h"

namespace RETARGET_API retarget {

/// A shape of a scene, in its body's frame. All shapes are solid: a plane fills the half space
/// below its z = 0, and the space below a height field is part of it.
struct SceneShape {
  enum class Type : unsigned char { kPlane, kBox, kSphere, kCapsule, kCylinder, kMesh };
  Type type = Type::kBox;
  Pose body_from_shape;
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  ///< Box, metres.
  double radius = 0.0;                                  ///< Sphere, capsule and cylinder, metres.
  double half_length = 0.0;  ///< Capsule (between the centres of its ends) and cylinder, along z,
                             ///< metres.
  std::shared_ptr<const TriangleMesh> mesh;  ///< Mesh and height field, in the shape's frame.
};

/// A rigid part of a scene.
struct SceneBody {
  std::string name;
  std::vector<SceneShape> shapes;
  Pose world_from_body;  ///< Pose in the file; metres, Z up.
  bool moves = false;    ///< It has a free joint in the file, or a track.
  double mass = 0.0;     ///< kg; 0: unknown.
};

/// The environment of a human or a robot, without the floor z = 0.
struct Scene {
  std::string name;  ///< File name, for messages.
  std::vector<SceneBody> bodies;

  /// Index of the body with this name; -1 if it does not exist.
  [[nodiscard]] int find(const std::string& body) const;
};

/// Names in files of the human's parts, other than the feet, that may touch a body of a scene.
inline constexpr std::array<std::string_view, 8> kSupportNames = {
    "left_knee", "right_knee", "left_elbow", "right_elbow",
    "left_hand", "right_hand", "seat",       "back"};

/// Returns the part on the other side: `right_hand` for `left_hand`; `seat` for `seat`.
[[nodiscard]] std::string part_of_other_side(const std::string& part);

/// Contacts of a part of the human with a body of a scene, from a file.
struct StatedContact {
  std::string part;           ///< One of kSupportNames.
  std::size_t body = 0;       ///< Index of a body of the scene; in a track: 0.
  std::vector<char> touches;  ///< Whether they touch, one entry per frame.
};

/// The path of one moving body.
struct ObjectTrack {
  std::string body;                   ///< Empty: the only moving body.
  std::optional<FrameRate> rate;      ///< Empty: the rate of the clip.
  std::vector<Pose> world_from_body;  ///< One pose per frame; metres, Z up.
  /// Contacts of all parts with the body; empty: the file does not state them.
  std::vector<StatedContact> contacts;
};

/// A vertical plane of the world, for mirror images.
struct MirrorPlane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< Metres.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< Horizontal, unit length.
};

/// Replaces a scene and its tracks by their mirror images, as mirror() does with a clip. Exchanges
/// left and right in stated contacts.
void mirror_scene(const MirrorPlane& plane, Scene& scene, std::span<ObjectTrack> tracks);

/// A scene over time: poses of all bodies, per frame.
struct SceneClip {
  std::shared_ptr<const Scene> scene;
  FrameRate rate;
  int frame_count = 0;
  std::vector<Pose> world_from_body;    ///< Frame-major.
  std::vector<StatedContact> contacts;  ///< Contacts of bodies whose tracks state them.

  [[nodiscard]] const Pose& pose(int frame, std::size_t body) const {
    return world_from_body[static_cast<std::size_t>(frame) * scene->bodies.size() + body];
  }
};

/// Reads a scene: MJCF, URDF, OBJ, STL or COLLADA, or a JSON list of primitives (docs/world.md).
/// A floor at z = 0 is omitted, because every clip has one.
///
/// Errors (kInput): a file that cannot be read, without shapes, or with shapes that are not
/// supported; numbers that are not finite.
[[nodiscard]] Result<Scene> load_scene(const std::string& file);

/// Returns the file of a track's specification, FILE or BODY=FILE. If a file named exactly `spec`
/// exists, it is used as the file.
[[nodiscard]] std::string object_track_file(const std::string& spec);

/// Reads the track of an object from NPZ, NPY, CSV, or the columns of InterMimic's tensors.
/// @param spec  FILE, or BODY=FILE.
[[nodiscard]] Result<ObjectTrack> load_object_track(const std::string& spec);

/// Samples tracks at the times of a clip: frames [begin, begin + frame_count) at `rate`, where the
/// tracks have one pose per frame of the clip before it was cut and resampled.
struct ClipTimes {
  FrameRate source_rate;  ///< Rate of the source clip.
  int source_frames = 0;  ///< Number of frames of the source clip.
  int source_begin = 0;   ///< First used frame of the source clip.
  FrameRate rate;         ///< Frame rate of the result.
  int frame_count = 0;    ///< Number of frames of the result.
};

/// Places all bodies of a scene in every frame of a clip. Positions are interpolated by cubic
/// splines and rotations by slerp.
///
/// A track may move any body, except an infinite plane: the scene of the result marks it as moving.
/// A track without a body's name moves the only moving body, or the only body. Moving bodies
/// without a track stay where the file places them. A track with its own rate starts when the clip
/// as read starts.
///
/// Errors (kInput): a track of a body that the scene does not have, or of a plane; a track that is
/// shorter than the clip; two tracks of a body.
[[nodiscard]] Result<SceneClip> place_scene(const std::shared_ptr<const Scene>& scene,
                                            std::span<const ObjectTrack> tracks,
                                            const ClipTimes& times);

/// The nearest surface of a body. Inside solids that consist of several shapes, the distance is
/// that to the nearest surface of any shape that contains the point.
struct SurfaceDistance {
  double distance = 0.0;                              ///< Signed, metres; negative inside.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Gradient of the distance, unit length.
};

/// The signed distance to one body of a scene: closed forms for primitives, a grid with C1
/// interpolation for meshes. Immutable; copies share the grids.
class DistanceField {
 public:
  DistanceField() = default;

  /// @param in_body  point in the frame of the body, metres.
  [[nodiscard]] SurfaceDistance at(const Eigen::Vector3d& in_body) const;
  /// A sphere about the origin of the body's frame that encloses all shapes, metres; infinite for
  /// planes.
  [[nodiscard]] double reach() const { return reach_; }
  /// The smallest value of z over all shapes if the body has this rotation, metres; it is relative
  /// to the body's origin.
  [[nodiscard]] double lowest(const Eigen::Quaterniond& world_from_body) const;

 private:
  friend Result<DistanceField> make_distance_field(const SceneBody& body, const std::string& cache);
  struct Part;
  std::vector<std::shared_ptr<const Part>> parts_;
  double reach_ = 0.0;
};

/// Builds the distance field of a body.
/// @param cache  folder for the grids of meshes, by content hash; empty: none. Failure to write it
///     is not an error.
/// Errors (kInput): a mesh whose grid would exceed the size limit.
[[nodiscard]] Result<DistanceField> make_distance_field(const SceneBody& body,
                                                        const std::string& cache = {});

/// The folder for cached grids: $XDG_CACHE_HOME/retarget or ~/.cache/retarget; empty if neither
/// variable is set.
[[nodiscard]] std::string distance_cache_folder();

}  // namespace retarget
