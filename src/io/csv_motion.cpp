// Motions in CSVs.

#include <cstddef>
#include <string>
#include <string_view>

#include "base/try.h"
#include "io/csv_columns.h"
#include "io/raw_motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

Result<RawMotion> read_csv_motion(std::string_view text, const Robot& robot,
                                  const std::string& file, const ReadMotionOptions& options) {
  TRY_ASSIGN(const auto table, read_csv_table(text, file));
  TRY_ASSIGN(const auto columns, find_csv_columns(table, robot, file, options));
  RawMotion raw;
  raw.format = columns.soma ? MotionFormat::kCsvSoma : MotionFormat::kCsv;
  raw.frames = table.rows();
  raw.joint_count = columns.joints.size();
  raw.degrees = columns.degrees;
  raw.metres_per_unit = columns.metres_per_unit;
  for (const auto& [column, joint] : columns.joints) raw.joint_indices.push_back(joint);
  TRY(take_csv_rate(table, columns, file, options, raw));
  if (options.ignore_header && !table.header.empty()) {
    raw.notes.push_back("columns by position: the header is ignored");
  }
  const bool euler = columns.euler[0] != kNoColumn && !columns.quaternion_named;
  if (columns.quaternion_named || euler) raw.order = QuaternionOrder::kXyzw;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    for (const int column : columns.position) raw.position.push_back(row[column]);
    if (euler) {
      for (const int column : columns.euler) raw.euler.push_back(row[column]);
    } else {
      for (const int column : columns.quaternion) raw.rotation.push_back(row[column]);
    }
    for (const auto& [column, joint] : columns.joints) raw.joints.push_back(row[column]);
  }
  return raw;
}

}  // namespace retarget
