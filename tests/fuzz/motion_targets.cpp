// Any bytes as a robot's motion.

#include <cmath>
#include <cstddef>
#include <string_view>

#include "fuzz/fuzz_target.h"
#include "retarget/compare.h"
#include "retarget/csv_table.h"
#include "retarget/motion_io.h"

namespace retarget::fuzz {

void fuzz_csv(std::string_view bytes) {
  const auto table = read_csv_table(bytes, "fuzz.csv");
  if (!good(table)) return;
  require(table->values.size() == table->rows() * table->columns, "rows are of one length");
  for (const double value : table->values) require(std::isfinite(value), "numbers are finite");
}

void fuzz_motion(std::string_view bytes) {
  ReadMotionOptions told;
  told.rate = FrameRate{30, 1};
  told.quaternion = QuaternionOrder::kXyzw;
  for (const ReadMotionOptions& options : {ReadMotionOptions(), told}) {
    const auto read = parse_robot_motion(bytes, fuzz_robot(), "fuzz.csv", options);
    if (!good(read)) continue;
    require(read->clip.frame_count() > 0, "motions have frames");
    for (int frame = 0; frame < read->clip.frame_count(); ++frame) {
      const auto qpos = read->clip.qpos(frame);
      for (const double value : qpos) require(std::isfinite(value), "numbers are finite");
      const double square =
          qpos[3] * qpos[3] + qpos[4] * qpos[4] + qpos[5] * qpos[5] + qpos[6] * qpos[6];
      require(std::abs(square - 1.0) < 1e-9, "quaternions are of unit length");
    }
  }
}

void fuzz_motion_table(std::string_view bytes) {
  const auto table = parse_motion_table(bytes, "fuzz.csv");
  if (!good(table)) return;
  require(!table->columns.empty(), "tables have columns");
  require(table->values.size() == table->frames * table->columns.size(), "rows are of one length");
  for (const std::size_t first : table->quaternions) {
    require(first + 4 <= table->columns.size(), "quaternions are four columns");
  }
  (void)good(compare_motions(*table, *table, 0.0));
}

}  // namespace retarget::fuzz
