#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// Builds a binary glTF 2.0 file (GLB): JSON objects that refer to each other by index, and one
/// buffer of numbers. Khronos, "glTF 2.0 Specification", 2021.
class GltfWriter {
 public:
  using Json = nlohmann::ordered_json;

  /// The use of an accessor, which determines its buffer target.
  enum class Use : unsigned char {
    kVertices,  ///< A vertex attribute.
    kOther,     ///< Animation keys, skin matrices.
  };

  GltfWriter();

  /// Marks the file as the display of a robot, which readers of human motions reject.
  void mark_robot(const std::string& name);

  /// Appends an object to one of the lists (`nodes`, `meshes`, ...).
  /// @return its index.
  int add(const char* list, Json object);
  /// Returns the object at an index for completion.
  [[nodiscard]] Json& at(const char* list, int index);

  /// Adds an accessor of consecutive elements. @return the accessor's index.
  /// @param components  1, 3, 4 or 16: scalars, vectors, column-major matrices.
  int add_floats(std::span<const float> values, int components, Use use);
  int add_indices(std::span<const std::uint32_t> values);
  /// Adds four joint indices per vertex.
  int add_joints(std::span<const std::uint16_t> values);

  /// Returns the whole file. Errors (kRun): 4 GiB or more.
  /// @param roots  root nodes of the scene.
  [[nodiscard]] Result<std::string> finish(std::span<const int> roots);

 private:
  int add_accessor(int components, int component_type, std::size_t count, int target,
                   std::size_t first_byte);

  Json document_;
  std::string bytes_;
};

/// Node values [x, y, z] and [x, y, z, w], rounded to float like all numbers in the file.
[[nodiscard]] GltfWriter::Json gltf_vector(const Eigen::Vector3d& vector);
[[nodiscard]] GltfWriter::Json gltf_rotation(const Eigen::Quaterniond& rotation);

/// The rotation from a Z-up world to glTF's Y-up world. It is about x, so that programs that
/// convert back to Z up (Blender) show the original coordinates.
[[nodiscard]] Eigen::Quaterniond y_up_from_z_up();

/// Adds a plain material. @param colour  0xRRGGBB, sRGB. @return its index.
int add_gltf_material(GltfWriter& writer, std::string_view name, int colour);

/// Checks that all key times differ. They are single precision, which distinguishes only 2^24
/// frames with certainty. Errors (kRun): the message names the first time that repeats.
[[nodiscard]] Result<void> check_key_times(const FrameRate& rate, int frames);

/// Animation keys of node rotations and translations.
class GltfAnimation {
 public:
  GltfAnimation(GltfWriter& writer, std::string_view name);

  /// Adds the times of `frames` frames, starting at 0. @return the accessor, for add_translations
  /// and add_rotations.
  int add_times(const FrameRate& rate, int frames);

  /// @param times  accessor from add_times; `xyz` has one value per time.
  void add_translations(int node, int times, std::span<const float> xyz);
  /// Adds unit quaternions xyzw. Flips signs so that each is nearest to the previous key, which
  /// makes every player turn the short way.
  void add_rotations(int node, int times, std::span<float> xyzw);

  /// Adds the animation to the document unless it has no channels.
  void finish();

 private:
  void add_channel(int node, const char* path, int times, int values);

  GltfWriter& writer_;
  GltfWriter::Json animation_;
};

/// A triangle mesh with smooth normals. Front faces are counter-clockwise.
struct GltfMesh {
  std::vector<float> positions, normals;  ///< x y z per vertex; positions in metres.
  std::vector<std::uint32_t> triangles;   ///< Three vertex indices per triangle.

  [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }

  /// Adds a cylinder along z with hemispheres at its ends; a sphere if the length is zero.
  void add_capsule(const Pose& pose, double radius, double half_length);
  /// Adds a capsule between two points.
  void add_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius);
  void add_box(const Pose& pose, const Eigen::Vector3d& half_size);
  /// Adds a collision shape in the frame of its body.
  void add_shape(const CollisionShape& shape);

 private:
  void add_vertex(const Pose& pose, const Eigen::Vector3d& place, const Eigen::Vector3d& normal);
};

/// Creates a mesh primitive with the attributes POSITION and NORMAL.
/// @pre the mesh has triangles
[[nodiscard]] GltfWriter::Json gltf_primitive(GltfWriter& writer, const GltfMesh& mesh,
                                              int material);

}  // namespace retarget
