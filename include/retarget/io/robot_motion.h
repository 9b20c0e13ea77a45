#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/io/motion_format.h"
#include "retarget/io/robot_csv.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// What a motion file does not say, or says wrongly. Nothing: found, or as the format has it.
struct ReadMotionOptions {
  std::optional<MotionFormat> format;         ///< In place of what the content says.
  std::optional<FrameRate> rate;              ///< Of the file, whatever it says itself.
  std::optional<FrameRate> default_rate;      ///< Of files that say none; nothing: 30, SOMA's 120.
  std::optional<QuaternionOrder> quaternion;  ///< Of the root, where no header tells.
  /// Hinges, and a root's Euler angles, of a CSV or a pickle; false: radians.
  std::optional<bool> degrees;
  std::optional<double> metres_per_unit;  ///< Root position and slides of a CSV or a pickle.
  bool ignore_header = false;             ///< Columns of a CSV by their number, whatever it has.
  std::string variant;                    ///< Of the robot: whose joints the columns are.
  std::string motion;                     ///< One of several in a kPklPbhc file.
  /// Of the file, and of the numbers of an NPZ's array: more are refused.
  std::size_t most_bytes = std::numeric_limits<std::size_t>::max();
};

/// A motion file as it was read.
struct RobotMotion {
  RobotClip clip;
  MotionFormat format = MotionFormat::kCsv;
  bool rate_known = false;            ///< The file has a rate, or one was given.
  std::vector<std::string> notes;     ///< What was found or guessed, for people; one line each.
  std::vector<std::string> warnings;  ///< What is odd, for people; one line each.
  std::size_t bytes = 0;              ///< Of the file.
};

/// Reads a robot's motion from any file that docs/formats.md names; the kind is found by content.
///
/// * CSV: columns by the header's names (letter case, quotes, a path before them and units behind
///   them aside), which must all be understood and name all joints of the robot or of one of its
///   variants; without a header by their number: 7 of the root and the joints of the robot or of one
///   of its variants, one more in front when it counts up. Frame numbers are passed over, times in
///   s, ms, us or ns give the rate; SOMA's frame numbers count frames of 120 a second, so that every
///   fourth of them means 30. What names no unit is in radians and metres, as our own files are.
///   Joints beyond the robot's widest range by more than half a radian, and a root higher than five
///   times what the robot's limbs reach, are refused then; joints beyond their own ranges in most
///   frames, and a root that is never near the ground or too fast, are warned of. SOMA's and
///   BONES-SEED's files are known by their header.
/// * The order of the root's quaternion: of both readings the one that stands upright, else the one
///   whose lowest sole point slips less. Where both are alike (a robot that stands still, facing
///   along x) xyzw, the usual order; a body that lies still is refused.
/// * GMR's pickle, PBHC's and ASAP's (also joblib's, compressed or not); read_pickle says what is
///   refused.
/// * Tracking NPZ: which order joints and bodies are in is found by forward kinematics. They are in
///   radians and metres; options that say units are refused.
///
/// Joints that are no columns stand as in the zero configuration, joints that the robot's variant
/// holds where it holds them. Quaternions are normalised and made sign-continuous.
///
/// @param bytes  the whole file.
/// @param file   for messages.
/// @return kInput errors: malformed files; what cannot be told, with the option that tells it.
[[nodiscard]] Result<RobotMotion> parse_robot_motion(std::string_view bytes,
                                                     const std::shared_ptr<const Robot>& robot,
                                                     const std::string& file,
                                                     const ReadMotionOptions& options = {});

/// parse_robot_motion of a file; `-` reads standard input.
[[nodiscard]] Result<RobotMotion> load_robot_motion(const std::string& path,
                                                    const std::shared_ptr<const Robot>& robot,
                                                    const ReadMotionOptions& options = {});

}  // namespace retarget
