#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edit/ground_pose.h"
#include "human/human_clip.h"
#include "retarget/error.h"

namespace retarget {

struct SeamOptions {
  double window = 1.0 / 3.0;  ///< Of the frames that are compared and blended, seconds.
  double band = 2.0;          ///< Searched at the end of a and at the beginning of b, seconds.
  bool search_all = false;    ///< Search both clips as a whole.
  /// What it costs to leave out a second of either clip, metres of distance: of equally good seams
  /// the one that keeps most is taken.
  double cost_of_second = 0.01;
  double cost_of_all = 0.2;  ///< The same by the share of both clips that is left out, of all.
  /// Where other feet are planted in the one than in the other, the distance counts so much more.
  double other_support = 0.5;
  int most_seams = 4;  ///< How many places are given.
};

/// Where two clips of one rate fit together: frame a_frame of a meets b_frame of b.
struct Seam {
  int a_frame = 0, b_frame = 0;
  int overlap = 1;      ///< Frames, from these on, that both clips have (at most the window).
  GroundPose a_from_b;  ///< Brings b over the ground to a: of the world, about its origin.
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< The same of b's hips at b_frame, metres.
  double distance = 0.0;                          ///< As WindowDistance, metres.
  bool same_support = true;                       ///< The same feet are planted in both.
  std::string worst_bone;                         ///< Farthest from its counterpart at the seam,
  double worst_distance = 0.0;                    ///< by so many metres.
  double speed_difference = 0.0;                  ///< Root mean square over the bones, m/s.
};

/// Distances of all windows that were searched, row by row: rows are frames of a.
struct SeamMap {
  int a_begin = 0, b_begin = 0;  ///< The frames of the first row and column.
  int width = 0;                 ///< Frames of b.
  std::vector<float> distances;  ///< Metres.
};

struct SeamSearch {
  std::vector<Seam> seams;  ///< The best one, then the next best elsewhere; one at least.
  SeamMap map;
};

/// Finds where b goes on best from a: the least distance of Kovar, Gleicher and Pighin (2002) over
/// windows of bone positions (all bones alike), each window turned and moved over the ground as
/// fits best; see WindowDistance. Where the clips share less than a window, the distance counts
/// more by half the share that is missing, and so it does where other feet are on the floor. Frames
/// that both clips have, at the end of a and the beginning of b, are found before all else.
///
/// @param a_file, b_file  for messages.
/// @return kInput errors: a clip without frames; no bones in common. kUsage errors: more than 16
///     million pairs of frames to search.
[[nodiscard]] Result<SeamSearch> find_seam(const HumanClip& a, const HumanClip& b,
                                           const SeamOptions& options, const std::string& a_file,
                                           const std::string& b_file);

/// The map as a picture (binary PGM, 8 bit): black is the least distance, white the largest.
[[nodiscard]] std::string format_pgm(const SeamMap& map);

}  // namespace retarget
