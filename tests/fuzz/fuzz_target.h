#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget::fuzz {

/// A reader of untrusted bytes: accepted input must be valid, rejections must state the reason.
struct FuzzTarget {
  std::string_view name;
  /// Ends the process if the reader violates a property.
  void (*run)(std::string_view bytes);
};

/// All targets; docs/security.md lists them.
[[nodiscard]] std::span<const FuzzTarget> fuzz_targets();

/// The target of a name; nullptr for unknown names.
[[nodiscard]] const FuzzTarget* find_fuzz_target(std::string_view name);

/// Prints the violated property and ends the process, so that a fuzzer keeps the input.
void require(bool condition, const char* what);

/// Returns whether the input was read; otherwise the error must have a message.
template <typename Value>
bool good(const Result<Value>& result) {
  if (!result) require(!result.error().message.empty(), "errors say something");
  return result.has_value();
}

/// Requires rotations of unit length and finite translations in all frames.
void check_frames(const Clip& clip);

/// Path of a file with these bytes, for readers that only read files; the next call overwrites it.
[[nodiscard]] std::string file_of(std::string_view bytes, const char* name);

/// The Unitree G1 of the repository, for motions and settings.
[[nodiscard]] const std::shared_ptr<const Robot>& fuzz_robot();

/// Lines of a stream in a format.
void fuzz_decoder(std::string_view format, std::string_view bytes);
/// Binary packets of a format, each preceded by two bytes with its size: as datagrams, and as the
/// bytes of a connection; an empty one ends the connection.
void fuzz_packets(std::string_view format, std::string_view bytes);

void fuzz_bvh(std::string_view bytes);
void fuzz_npy(std::string_view bytes);
void fuzz_npz(std::string_view bytes);
void fuzz_smpl(std::string_view bytes);
void fuzz_smpl_arrays(std::string_view bytes);
void fuzz_smpl_body(std::string_view bytes);
void fuzz_pickle(std::string_view bytes);
void fuzz_torch(std::string_view bytes);
void fuzz_csv(std::string_view bytes);
void fuzz_motion(std::string_view bytes);
void fuzz_motion_table(std::string_view bytes);
void fuzz_retargeting_config(std::string_view bytes);
void fuzz_skeleton_profile(std::string_view bytes);
void fuzz_bone_map(std::string_view bytes);
void fuzz_path(std::string_view bytes);
void fuzz_fit_options(std::string_view bytes);
void fuzz_gates(std::string_view bytes);
void fuzz_limits(std::string_view bytes);
void fuzz_profile(std::string_view bytes);
void fuzz_model(std::string_view bytes);
void fuzz_urdf(std::string_view bytes);
void fuzz_manifest(std::string_view bytes);
void fuzz_sidecar(std::string_view bytes);
void fuzz_mesh(std::string_view bytes);
void fuzz_line(std::string_view bytes);
void fuzz_fbx(std::string_view bytes);
void fuzz_gltf(std::string_view bytes);
void fuzz_mvnx(std::string_view bytes);
void fuzz_scene(std::string_view bytes);
void fuzz_object_track(std::string_view bytes);
void fuzz_stream_record(std::string_view bytes);

}  // namespace retarget::fuzz
