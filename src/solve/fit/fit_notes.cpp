#include "solve/fit/fit_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/option_name.h"
#include "solve/fit/fit_dynamics.h"

namespace retarget {
namespace {

// Whether so many frames of a clip are worth a note.
bool is_notable(int frames, const FitClip& clip) {
  constexpr double kShare = 0.05, kTime = 0.5;  // Share of the frames, seconds.
  return frames >= kShare * clip.frame_count && frames * clip.frame_time >= kTime;
}

}  // namespace

void note_missing_feet(const Robot& robot, const SourceSides& sides, FitReport& report) {
  if (robot.fixed_base()) {
    report.notes.emplace_back("fixed base: the fit has no foot, contact and floor terms");
  } else if (robot.profile().soles.empty()) {
    report.notes.emplace_back(
        "the robot has no soles: the fit has no contact and foot height terms");
  } else if (!sides.left && !sides.right) {
    report.notes.emplace_back(
        "the source has no feet: the fit has no contact and foot height terms");
  } else if (!sides.left || !sides.right) {
    report.notes.emplace_back(std::string("the source has no ") + (sides.left ? "right" : "left") +
                              " foot: the fit has contacts of the other foot only");
  }
}

void note_dynamics(const FitOptions& options, const FitModel& model, FitReport& report) {
  if (!options.dynamics || FitDynamics::possible(model)) return;
  report.notes.emplace_back("the robot has no masses or no feet: the fit has no dynamics term");
}

void note_raised_feet(const FitClip& clip, FitReport& report) {
  const RaisedFrames raised = raised_frames(clip.feet, clip.frame_count);
  if (!is_notable(raised.count, clip)) return;
  report.notes.push_back(fmt::format(
      "in {:.0f} % of the frames, the feet stand only on raised surfaces (up to {:.2f} m) that are "
      "not in the motion: `retarget scene-from-motion` finds them for " OPTION(
          "scene") "; if the human's floor was flat, the height of the root is wrong",
      100.0 * raised.count / clip.frame_count, raised.highest));
}

void note_seats(const std::vector<SeatRest>& seats, const FitClip& clip, double floor,
                FitReport& report) {
  int frames = 0;
  double highest = 0.0;
  for (const SeatRest& seat : seats) {
    frames += seat.frames.end - seat.frames.begin;
    highest = std::max(highest, seat.height - floor);
  }
  if (!is_notable(frames, clip)) return;
  report.notes.push_back(fmt::format(
      "in {:.0f} % of the frames, the human sits on something (up to {:.2f} m high) that is not in "
      "the motion: `retarget scene-from-motion` finds it for " OPTION("scene"),
      100.0 * frames / clip.frame_count, highest));
}

void note_floor(const StandingHeights& standing, FitReport& report) {
  if (!standing.from_body) return;
  report.notes.emplace_back(
      "no foot stands long enough: the floor is where the lowest part of the body rests");
}

}  // namespace retarget
