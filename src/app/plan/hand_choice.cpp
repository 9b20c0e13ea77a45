#include "app/plan/hand_choice.h"

#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <vector>

#include "motion/lost_end.h"
#include "retarget/clip_range.h"
#include "retarget/options.h"
#include "solve/hands/hand_track.h"

namespace retarget {

SourceHands choose_hands(const Clip& clip, const Plan& plan) {
  const SolveOptions& solve = plan.options.solve;
  return followed_hands(
      clip, plan.human.map, find_hands(*plan.robot.robot), hands_rule(solve.hands, solve.method),
      {count_lead_in_frames(clip), clip.frame_count() - count_lost_end_frames(clip)});
}

namespace {

std::string hands_text(const Clip& clip, const Plan& plan) {
  const SolveOptions& solve = plan.options.solve;
  const HandsRule rule = hands_rule(solve.hands, solve.method);
  const RobotHands hands = find_hands(*plan.robot.robot);
  if (solve.hands != HandsRule::kAuto && !hands[0] && !hands[1]) {
    return "the robot has no fingers to move";
  }
  if (rule == HandsRule::kOff) return {};
  const SourceHands followed = choose_hands(clip, plan);
  std::vector<std::string> follow, relaxed;
  for (std::size_t side = 0; side < hands.size(); ++side) {
    if (!hands[side]) continue;
    (followed[side] ? follow : relaxed).emplace_back(side == 0 ? "left" : "right");
  }
  std::string text;
  if (!follow.empty()) text = fmt::format("{} following the human", fmt::join(follow, " and "));
  if (!relaxed.empty()) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} relaxed", fmt::join(relaxed, " and "));
    if (rule == HandsRule::kAuto) {
      text += ": the source has no finger motion and no closed hand there";
    } else if (rule == HandsRule::kFollow) {
      text += ": the source has no finger pose there";
    }
  }
  return text;
}

}  // namespace

void note_hands(const Clip& clip, Plan& plan) {
  const std::string text = hands_text(clip, plan);
  const auto line = std::ranges::find(plan.config_notes, "hands", &SummaryLine::label);
  if (line != plan.config_notes.end()) {
    line->text = text;
  } else if (!text.empty()) {
    plan.config_notes.push_back({"hands", text});
  }
}

}  // namespace retarget
