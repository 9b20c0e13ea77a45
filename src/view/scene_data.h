#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/motion_scene.h"
#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// Compresses bytes as one zlib stream, in base64.
[[nodiscard]] Result<std::string> packed_text(std::string_view bytes);

/// Encodes time series compactly for embedding in a page: rounded to a step, as differences between
/// frames, deflated.
///
/// Layout of a track: first one byte per channel, the order of differences (0 to 2); then four byte
/// planes, from the lowest byte to the highest, of channels x frames values, channel by channel. A
/// value v is stored unsigned: as 2v, or as -2v - 1 if negative. Differences and their sums wrap at
/// 32 bits, so they are exact.
class TrackPacker {
 public:
  struct Track {
    int channels = 0;
    int frames = 0;
    double step = 0.0;  ///< Values are multiples of this; the error is at most half of it.
  };

  /// Adds a track. Errors (kInput): a value that is not finite or more than a billion steps from 0.
  /// @param values  frame-major.
  /// @return its index in tracks().
  [[nodiscard]] Result<int> add(int channels, double step, std::span<const double> values);

  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }
  /// Packs all tracks in order with packed_text.
  [[nodiscard]] Result<std::string> finish() const { return packed_text(bytes_); }

 private:
  std::vector<Track> tracks_;
  std::string bytes_;
};

/// Why a page cannot hold a scene; empty if it can.
[[nodiscard]] std::string scene_excess(const SceneClip& scene);

/// Adds a mesh as two tracks whose frames are vertices (metres) and triangles, and puts their
/// indices into `json`. Errors: those of TrackPacker::add.
[[nodiscard]] Result<void> pack_mesh(const TriangleMesh& mesh, TrackPacker& packer,
                                     nlohmann::ordered_json& json);

/// Makes the scenes of a page. A mesh that several scenes share is written once.
class ScenePacker {
 public:
  /// Packs a scene: `bodies` with names and shapes at the size in the robot's world; the worlds
  /// `robot` and, if there is one, `human`. A world has the number of `frames`, `poses` by body
  /// (null: the body moves), and tracks of the moving bodies, body by body: `position` (metres) and
  /// `rotation` (wxyz). `scale`: size of static bodies in the robot's world relative to the
  /// human's. Errors: those of TrackPacker::add.
  [[nodiscard]] Result<nlohmann::ordered_json> pack(const MotionScene& scene, TrackPacker& packer);

 private:
  [[nodiscard]] Result<nlohmann::ordered_json> shape_json(const SceneShape& shape,
                                                          TrackPacker& packer);

  std::map<const TriangleMesh*, nlohmann::ordered_json> meshes_;
};

/// The contacts of a motion with bodies of its scene, a list of objects: `part`, `surface`, and
/// `phases`, frames [begin, end) sorted by time.
/// @param frames  frame count of the motion; contacts end there.
[[nodiscard]] nlohmann::ordered_json page_touches(const ContactLabels& labels, int frames);

}  // namespace retarget
