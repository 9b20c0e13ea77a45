#include "app/plan/clean_source.h"

#include <algorithm>
#include <vector>

#include "base/option_name.h"
#include "human/gait/clean_clip.h"
#include "human/gait/clean_positions.h"
#include "human/skeleton/robot_human.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// The published method does not clean clips, and robots' motions have no noise.
bool may_clean(const Clip& clip, const Options& options) {
  return options.human.clean == CleanRule::kAuto && options.solve.method != Method::kGmr &&
         !is_of_robot(clip);
}

// Raises the contact thresholds above the remaining noise of standing feet. Height thresholds grow
// in proportion to the speed threshold.
void look_above_noise(double foot_speed, FitOptions& fit) {
  constexpr double kFastest = 0.45, kRelease = 5.0 / 3.0;
  constexpr double kHigher = 0.02, kReleaseHigher = 0.03;  // Metres, at kFastest.
  const double speed = std::min(foot_speed, kFastest);
  if (!(speed > fit.contact_speed)) return;
  const double share = (speed - fit.contact_speed) / (kFastest - fit.contact_speed);
  fit.contact_speed = speed;
  fit.contact_release_speed = std::max(fit.contact_release_speed, kRelease * speed);
  fit.contact_height += kHigher * share;
  fit.contact_release_height += kReleaseHigher * share;
}

}  // namespace

std::string clean_source_positions(Clip& clip, const Options& options) {
  return may_clean(clip, options) ? clean_positions(clip) : std::string();
}

void clean_source(Clip& clip, const std::string& positions, Plan& plan) {
  if (!may_clean(clip, plan.options)) return;
  CleanReport report = clean_clip(clip, plan.part, plan.human.calibration, !positions.empty());
  if (!positions.empty()) report.notes.insert(report.notes.begin(), positions);
  if (!report.acted()) return;
  for (const std::string& note : report.notes) {
    plan.clip_notes.push_back({&note == report.notes.data() ? "cleaned" : "", note});
  }
  plan.clip_notes.push_back({"", OPTION("clean") " off uses the clip unchanged"});
  look_above_noise(report.foot_speed, plan.fit);
}

}  // namespace retarget
