#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Puts a glTF 2.0 file together in its binary form (GLB): JSON objects that refer to each other by
/// index, and one buffer of numbers. Khronos, "glTF 2.0 Specification", 2021.
class GltfWriter {
 public:
  using Json = nlohmann::ordered_json;

  /// What the numbers of an accessor are for.
  enum class Use : unsigned char {
    kVertices,  ///< A vertex attribute.
    kOther,     ///< Keys of animations, matrices of skins.
  };

  GltfWriter();

  /// Appends an object to one of the lists (`nodes`, `meshes`, ...).
  /// @return its index.
  int add(const char* list, Json object);
  /// The object of an index, to be completed.
  [[nodiscard]] Json& at(const char* list, int index);

  /// Accessors of numbers, one element after the other. @return the accessor's index.
  /// @param components  1, 3, 4 or 16: scalars, vectors, column-major matrices.
  int add_floats(std::span<const float> values, int components, Use use);
  int add_indices(std::span<const std::uint32_t> values);
  /// Four joints for each vertex.
  int add_joints(std::span<const std::uint16_t> values);

  /// The whole file. Errors (kRun): 4 GiB or more.
  /// @param roots  nodes of the scene.
  [[nodiscard]] Result<std::string> finish(std::span<const int> roots);

 private:
  int add_accessor(int components, int component_type, std::size_t count, int target,
                   std::size_t first_byte);

  Json document_;
  std::string bytes_;
};

/// Values of nodes: [x, y, z], [x, y, z, w]; rounded to float, as everything in the file.
[[nodiscard]] GltfWriter::Json gltf_vector(const Eigen::Vector3d& vector);
[[nodiscard]] GltfWriter::Json gltf_rotation(const Eigen::Quaterniond& rotation);

/// What turns a world with Z up into glTF's, whose Y is up: about x, so that programs that turn Z up
/// again (Blender) show the coordinates that the motion has.
[[nodiscard]] Eigen::Quaterniond y_up_from_z_up();

/// A plain material. @param colour  0xRRGGBB, sRGB. @return its index.
int add_gltf_material(GltfWriter& writer, std::string_view name, int colour);

/// Whether each key has a time of its own: times are single precision, which tells no more than 2^24
/// frames apart for sure. Errors (kRun): it names the first that repeats.
[[nodiscard]] Result<void> check_key_times(const FrameRate& rate, int frames);

/// Keys of an animation that a node's rotation or translation follows.
class GltfAnimation {
 public:
  GltfAnimation(GltfWriter& writer, std::string_view name);

  /// Times of frames from 0 on. @return the accessor, for add().
  int add_times(const FrameRate& rate, int frames);

  /// @param times  of add_times; there are as many values.
  void add_translations(int node, int times, std::span<const float> xyz);
  /// Unit quaternions xyzw; of q and -q the one nearer to the key before is taken, so that every
  /// player turns the short way.
  void add_rotations(int node, int times, std::span<float> xyzw);

  /// Puts the animation into the document; one without channels is left out.
  void finish();

 private:
  void add_channel(int node, const char* path, int times, int values);

  GltfWriter& writer_;
  GltfWriter::Json animation_;
};

}  // namespace retarget
