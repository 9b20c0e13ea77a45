#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file_endings.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Range of frame rates that a file may declare, Hz.
inline constexpr double kMinFileRate = 1e-3;
inline constexpr double kMaxFileRate = 1e6;

/// A motion as stored in its file. The columns are identified; units and orders may still be
/// unknown.
struct RawMotion {
  MotionFormat format = MotionFormat::kCsv;
  std::optional<FrameRate> rate;  ///< As declared in the file.
  std::size_t frames = 0;
  std::vector<double> position;  ///< 3 per frame.
  std::vector<double> rotation;  ///< 4 per frame, in the file's order.
  /// Instead of `rotation`: 3 per frame, angles about the fixed axes x, y, z (R = Rz Ry Rx), in the
  /// unit of the joints.
  std::vector<double> euler;
  std::optional<QuaternionOrder> order;            ///< Set if the file declares it.
  QuaternionOrder usual = QuaternionOrder::kXyzw;  ///< The format's usual order.
  std::vector<double> joints;                      ///< joint_count per frame.
  std::size_t joint_count = 0;
  std::vector<int> joint_indices;  ///< Into Robot::joints(); empty: identified by their count.
  std::optional<bool> degrees;     ///< Set if the file declares the unit.
  std::optional<double> metres_per_unit;     ///< Set if the file declares the unit.
  std::optional<FootContacts> contacts;      ///< Empty if the file has none.
  std::vector<std::string> notes, warnings;  ///< As in RobotMotion.
};

/// Readers of a family of formats, for the table of formats.
[[nodiscard]] Result<RawMotion> read_csv_motion(std::string_view bytes,
                                                const std::shared_ptr<const Robot>& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_npz_motion(std::string_view bytes,
                                                const std::shared_ptr<const Robot>& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_pickle_motion(std::string_view bytes,
                                                   const std::shared_ptr<const Robot>& robot,
                                                   const std::string& file,
                                                   const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_protomotions(std::string_view bytes,
                                                  const std::shared_ptr<const Robot>& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);
/// Reads the folder `file`; `bytes` are not used.
[[nodiscard]] Result<RawMotion> read_sonic_folder(std::string_view bytes,
                                                  const std::shared_ptr<const Robot>& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);

/// Converts a motion from the units and orders of its file to the robot's.
[[nodiscard]] Result<RobotMotion> interpret_motion(RawMotion& raw,
                                                   const std::shared_ptr<const Robot>& robot,
                                                   const std::string& file,
                                                   const ReadMotionOptions& options);

/// Maps the joints of a file with `count` joints to the robot's: its output joints, those of the
/// whole robot, or those of one of its variants. Errors (kInput): no such set, or several, have
/// this count.
[[nodiscard]] Result<std::vector<int>> joints_by_count(const Robot& robot, std::size_t count,
                                                       const RawMotion& raw,
                                                       const std::string& file,
                                                       const std::string& variant);

/// The robot's variants with this number of output joints; only `variant` if it is not empty. If
/// several fit a PBHC file, only the variants made for that format remain.
[[nodiscard]] std::vector<std::string> variants_by_count(const Robot& robot, std::size_t count,
                                                         MotionFormat format,
                                                         const std::string& variant);

/// Output joints of a variant; of the whole robot if `name` is empty.
[[nodiscard]] std::vector<int> output_joints_of(const Robot& robot, const std::string& name);

}  // namespace retarget
