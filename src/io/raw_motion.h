#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Frames a second that a file may claim.
inline constexpr double kMinFileRate = 1e-3;
inline constexpr double kMaxFileRate = 1e6;

/// A motion as its file has it: which columns are what is known, units and orders may not be.
struct RawMotion {
  MotionFormat format = MotionFormat::kCsv;
  std::optional<FrameRate> rate;  ///< As the file says.
  std::size_t frames = 0;
  std::vector<double> position;  ///< 3 a frame.
  std::vector<double> rotation;  ///< 4 a frame, in the order of the file.
  /// In their place: 3 a frame, angles about the fixed axes x, y, z (R = Rz Ry Rx), in the unit of
  /// the joints.
  std::vector<double> euler;
  std::optional<QuaternionOrder> order;            ///< Where the file tells.
  QuaternionOrder usual = QuaternionOrder::kXyzw;  ///< Of the format.
  std::vector<double> joints;                      ///< joint_count a frame.
  std::size_t joint_count = 0;
  std::vector<int> joint_indices;            ///< Into Robot::joints(); empty: by their number.
  std::optional<bool> degrees;               ///< Where the file tells.
  std::optional<double> metres_per_unit;     ///< Where the file tells.
  std::optional<FootContacts> contacts;      ///< Empty: the file has none.
  std::vector<std::string> notes, warnings;  ///< As in RobotMotion.
};

[[nodiscard]] Result<RawMotion> read_csv_motion(std::string_view text, const Robot& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_pickle_motion(std::string_view bytes, const std::string& file,
                                                   const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_npz_motion(std::string_view bytes,
                                                const std::shared_ptr<const Robot>& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);

[[nodiscard]] Result<RawMotion> read_protomotions(std::string_view bytes,
                                                  const std::shared_ptr<const Robot>& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);
/// Whether a folder holds a motion of kCsvSonic, and what is in it.
[[nodiscard]] bool is_sonic_folder(const std::string& path);
[[nodiscard]] Result<RawMotion> read_sonic_folder(const std::string& path, const Robot& robot,
                                                  const ReadMotionOptions& options);

/// Joints in the order of a file that has `count` of them: the robot's own columns, those of the
/// whole robot, or of one of its variants. Errors (kInput): none, or several, have as many.
[[nodiscard]] Result<std::vector<int>> joints_by_count(const Robot& robot, std::size_t count,
                                                       const RawMotion& raw,
                                                       const std::string& file,
                                                       const std::string& variant);

/// The robot's variants (`variant` alone, where it is named) that have so many output joints. Of PBHC's
/// files several are narrowed down to those made for it.
[[nodiscard]] std::vector<std::string> variants_by_count(const Robot& robot, std::size_t count,
                                                         MotionFormat format,
                                                         const std::string& variant);

/// The robot's own or a variant's output joints; `name` empty: the whole robot's.
[[nodiscard]] std::vector<int> output_joints_of(const Robot& robot, const std::string& name);

}  // namespace retarget
