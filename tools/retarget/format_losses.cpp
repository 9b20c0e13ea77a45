#include "format_losses.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/suggest.h"
#include "outputs.h"

namespace retarget::cli {

void warn_of_losses(const OutputOptions& options, const RobotClip& motion, Console& console) {
  const auto items = plan_outputs(options);
  if (!items) return;
  for (const OutputItem& item : *items) {
    if (item.format == MotionFormat::kCsvSoma && !soma_csv_tells(motion.rate())) {
      console.warn({{0, 0,
                     "csv-soma says no rate: its readers take 120 fps, this motion has " +
                         to_text(motion.rate()) + "; --fps 120 writes what they expect"}},
                   item.path);
    }
    if (item.format != MotionFormat::kPklPbhc) continue;
    const auto robot = pbhc_robot(motion.shared_robot());
    if (!robot || *robot == motion.shared_robot()) continue;
    const auto lost = lost_joints(motion, **robot);
    if (!lost) continue;
    console.warn({{0, 0,
                   "pkl-pbhc has the joints of the variant " + (*robot)->variant().name + ": " +
                       *lost + "; --dof " + (*robot)->variant().name + " does without them"}},
                 item.path);
  }
}

}  // namespace retarget::cli
