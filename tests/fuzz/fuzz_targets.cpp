#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fuzz/fuzz_target.h"
#include "retarget/load_robot.h"
#include "support/temporary_folder.h"

namespace retarget::fuzz {
namespace {

constexpr auto kTargets = std::to_array<FuzzTarget>({
    {"bvh", fuzz_bvh},
    {"npy", fuzz_npy},
    {"npz", fuzz_npz},
    {"smpl", fuzz_smpl},
    {"smpl_arrays", fuzz_smpl_arrays},
    {"smpl_body", fuzz_smpl_body},
    {"pickle", fuzz_pickle},
    {"torch", fuzz_torch},
    {"csv", fuzz_csv},
    {"motion", fuzz_motion},
    {"motion_table", fuzz_motion_table},
    {"ik_config", fuzz_retargeting_config},
    {"skeleton_profile", fuzz_skeleton_profile},
    {"bone_map", fuzz_bone_map},
    {"path", fuzz_path},
    {"fit_options", fuzz_fit_options},
    {"gates", fuzz_gates},
    {"limits", fuzz_limits},
    {"profile", fuzz_profile},
    {"model", fuzz_model},
    {"urdf", fuzz_urdf},
    {"manifest", fuzz_manifest},
    {"sidecar", fuzz_sidecar},
    {"mesh", fuzz_mesh},
    {"line", fuzz_line},
    {"fbx", fuzz_fbx},
    {"gltf", fuzz_gltf},
    {"mvnx", fuzz_mvnx},
    {"scene", fuzz_scene},
    {"object_track", fuzz_object_track},
    {"stream_lines", [](std::string_view bytes) { fuzz_decoder("lines", bytes); }},
    {"stream_bvh", [](std::string_view bytes) { fuzz_decoder("bvh", bytes); }},
    {"stream_vmc", [](std::string_view bytes) { fuzz_packets("vmc", bytes); }},
    {"stream_rokoko", [](std::string_view bytes) { fuzz_packets("rokoko", bytes); }},
    {"stream_smplx", [](std::string_view bytes) { fuzz_decoder("smplx", bytes); }},
    {"stream_xrobot", [](std::string_view bytes) { fuzz_decoder("xrobot", bytes); }},
    {"stream_mvn", [](std::string_view bytes) { fuzz_packets("mvn", bytes); }},
    {"stream_natnet", [](std::string_view bytes) { fuzz_packets("natnet", bytes); }},
    {"stream_record", fuzz_stream_record},
});

}  // namespace

std::span<const FuzzTarget> fuzz_targets() {
  return kTargets;
}

const FuzzTarget* find_fuzz_target(std::string_view name) {
  const auto* found = std::ranges::find(kTargets, name, &FuzzTarget::name);
  return found == kTargets.end() ? nullptr : found;
}

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not true: %s\n", what);
  std::abort();
}

void check_frames(const Clip& clip) {
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (const auto& rotation : clip.rotations(frame)) {
      require(std::abs(rotation.norm() - 1.0) < 1e-9, "rotations are of unit length");
    }
    for (const auto& translation : clip.translations(frame)) {
      require(translation.allFinite(), "translations are finite");
    }
  }
}

std::string file_of(std::string_view bytes, const char* name) {
  static const TemporaryFolder folder;
  return folder.write(name, std::string(bytes));
}

const std::shared_ptr<const Robot>& fuzz_robot() {
  static const std::shared_ptr<const Robot> g1 = [] {
    const std::string folder = std::string(RETARGET_SOURCE_DIR) + "/robots/unitree_g1/";
    auto loaded = load_robot_files(folder + "model.xml", folder + "robot.json");
    require(loaded.has_value(), "the robot loads");
    return *loaded;
  }();
  return g1;
}

}  // namespace retarget::fuzz
