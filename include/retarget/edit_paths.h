#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit_seams.h"
#include "retarget/edited.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"

// The path of a clip over the ground, and edits that change it.

namespace RETARGET_API retarget {

struct PathFitOptions {
  double tolerance = 0.05;   ///< Largest distance of the curve from the track, metres.
  double low_pass = 0.5;     ///< Cut-off frequency for the track of the hips, Hz; removes sway.
  double still_step = 0.03;  ///< Shortest step of the track, metres.
  double first_piece = 2.0;  ///< Length of the initial segments, metres.
  double min_piece = 0.25;   ///< Minimum length of a segment after splitting, metres.
  double still_speed = 0.1;  ///< A body below this speed has no direction of travel, m/s.
};

/// Frames [begin, end) in which the body stays in place.
struct StillPhase {
  int begin = 0, end = 0;
  double turn = 0.0;  ///< Turn of the hips from the frame before to the frame after, radians.
};

/// The path of a human over the ground, and the motion along it.
struct PathMotion {
  GroundPath path;
  std::vector<double> along;  ///< Metres along the path, per frame; never decreasing.
  std::vector<StillPhase> still;
  double largest_distance = 0.0;  ///< Distance of the path from the smoothed track, metres.

  /// Human-readable summary: length, segments, distance from the track.
  [[nodiscard]] std::string summary() const;
};

/// Fits a path to the track of the hips (Gleicher: Motion Path Editing, 2001).
///
/// The track is low-pass filtered without delay and thinned to steps of `still_step`, so that
/// standing still adds no path. A least-squares fit gives a chain of cubics, parametrised by chord
/// length, with one tangent at each joint and therefore without corners. Segments whose distance
/// from the track exceeds the tolerance are split, and the fit is repeated. A body that stays
/// within one step gets a path of one millimetre in the direction that it faces.
/// @return a kInput error for a clip without frames.
[[nodiscard]] Result<PathMotion> fit_path(const Clip& clip, const Calibration& calibration,
                                          const PathFitOptions& options = {});

/// The path that replaces the motion's own path. It begins where the own path begins, unless it is
/// read from a file.
struct PathChange {
  std::string to = {};   ///< `line`, `circle` or `figure8`, with the length of the own path; a JSON
                         ///< file; or empty for the own path.
  double radius = 3.0;   ///< Radius of a circle, metres; negative: to the right.
  double scale = 1.0;    ///< Scale about the beginning of the path.
  double degrees = 0.0;  ///< Rotation about the beginning of the path, positive to the left.

  [[nodiscard]] bool any() const { return !to.empty() || scale != 1.0 || degrees != 0.0; }
  /// @return a kUsage error for a radius below a centimetre.
  [[nodiscard]] Result<void> check() const;
};

/// Applies a change to a motion's own path.
/// @return kUsage errors of PathChange::check, kConfig errors of a path file.
[[nodiscard]] Result<GroundPath> change_path(const GroundPath& own, const PathChange& change);

/// Quantity that does not change when a path becomes longer or shorter.
enum class PathKeep : std::uint8_t {
  kTime,    ///< Duration: the motion covers the whole path in the same time.
  kSpeed,   ///< Speed over the ground: a longer path takes longer.
  kStride,  ///< Distance along the path per frame: the motion ends after the length of its own
            ///< path, or continues straight beyond the end of the new one.
};

struct FollowPathOptions {
  PathKeep keep = PathKeep::kTime;
  PathFitOptions fit;
  MotionLimits limits;  ///< Limits of the joints.
};

/// A motion on another path.
struct FollowedPath : Edited {
  PathMotion source;               ///< The motion's own path.
  std::vector<GroundPose> frames;  ///< Poses along the new path, per frame of the source.
  PlantSummary feet;
  SeamCheck check;  ///< Speeds and accelerations in the whole clip; faults if the path is too
                    ///< fast.
};

/// Maps a motion to another path. The body keeps its pose relative to the frame F that moves
/// along the path (position and tangent), so the body at s(t) on its own path moves by
/// F'(s'(t)) F(s(t))^-1. Corners of a path are turned at no more than 4 rad/s. Only the channels
/// that move the whole body change. Standing feet are then planted at the position in the middle
/// frame of each contact.
/// @return kInput errors of fit_path and turn_clip; kUsage errors: kSpeed for a motion that stays
///     in place or for a path more than 100 times longer or shorter.
[[nodiscard]] Result<FollowedPath> follow_path(const Clip& clip, const Calibration& calibration,
                                               const GroundPath& path,
                                               const FollowPathOptions& options);

/// A motion and the path that it follows, for draw_paths. Either may be null.
struct PathDrawing {
  const Clip* clip = nullptr;
  const GroundPath* path = nullptr;
};

/// Draws motions of one human from above as SVG: the track of the hips, the path with its control
/// points, and the positions of standing feet (toes if there are any; left and right have different
/// colours). x points to the right, y up, with a scale bar. The first motion is paler than the
/// others.
[[nodiscard]] std::string draw_paths(const Calibration& calibration,
                                     const std::vector<PathDrawing>& drawings);

}  // namespace retarget
