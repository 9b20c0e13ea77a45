#include "human/gait/rests.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "human/gait/frame_runs.h"
#include "human/gait/standing_heights.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Lengths in metres and speeds in m/s for a body with legs of kUsualSourceLeg.
constexpr double kLowestSurface = 0.06;  // The least height of a surface.
constexpr double kAlone = 0.1;           // Seconds in which a foot carries the body.
constexpr double kHalfFoot = 0.05;       // Half the width of a foot.
constexpr double kHeelLength = 0.05, kToeLength = 0.07;  // Beyond ankle and start of the toes.
constexpr double kStillSpeed = 0.12;                     // Of resting hips and hands.
constexpr double kShortestRest = 0.5;                    // Seconds.
constexpr double kLevelThigh = 0.6;  // Greatest sine of the slope of a sitting body's thigh.
constexpr double kBehindFeet = 0.2;  // Of sitting hips.
constexpr double kSeatDepth = 0.13;  // From the joint of the hips to the skin.
constexpr double kHalfSeat = 0.15;   // Half the width of a seat.
constexpr double kLowestSeat = 0.2, kLowestHand = 0.2;  // Lower hips rest on the floor.
constexpr double kHandStays = 0.02;                     // Maximum movement of a resting hand.
constexpr double kShoulderMoves = 0.1;                  // Minimum movement of its shoulder.
constexpr double kHandDepth = 0.03;                     // From the wrist to the skin.
constexpr double kHalfHand = 0.08;

// The corners of a sole in the middle of a stance.
void add_sole(int foot, const FrameRange& frames, double scale, const SourceFeet& feet,
              std::vector<Vector2d>& outline) {
  const SourceFoot& middle = feet.at((frames.begin + frames.end - 1) / 2, foot);
  const Vector2d heel = middle.end(kHeelEnd).head<2>(), toe = middle.toe.head<2>();
  if (!((toe - heel).norm() > 0.0)) return;
  const Vector2d ahead = (toe - heel).normalized(), aside(-ahead.y(), ahead.x());
  for (const double side : {-kHalfFoot * scale, kHalfFoot * scale}) {
    outline.push_back(heel - kHeelLength * scale * ahead + side * aside);
    outline.push_back(toe + kToeLength * scale * ahead + side * aside);
  }
}

class RestFinder {
 public:
  explicit RestFinder(const RestingHuman& of)
      : human_(*of.human),
        feet_(of.feet),
        contacts_(of.contacts),
        scale_(of.contacts.scale),
        floor_(floor_height(of.contacts)) {}

  std::vector<RaisedRest> run() {
    for (int foot = 0; foot < feet_.foot_count; ++foot) add_steps(foot);
    add_seats();
    for (const Side side : kSides) add_hands(side);
    std::ranges::stable_sort(rests_, {}, [](const RaisedRest& rest) { return rest.frames.begin; });
    return std::move(rests_);
  }

 private:
  [[nodiscard]] double frame_time() const { return human_.rate.frame_time(); }

  [[nodiscard]] Vector3d place(Bone bone, int frame) const {
    return human_.frame(frame)[bone].translation;
  }

  // Whether no other foot stands lower than a surface for long enough during a stance on it.
  [[nodiscard]] bool carries(int foot, const ContactPhase& stance) const {
    if (feet_.foot_count < 2) return true;
    double longest = 0.0;
    const auto other_is_lower = [&](int frame) {
      return std::ranges::any_of(
          contacts_.phases[static_cast<std::size_t>(1 - foot)], [&](const ContactPhase& other) {
            return frame >= other.begin && frame < other.end &&
                   other.support < stance.support - 0.5 * kLowestSurface * scale_;
          });
    };
    for_each_run(stance.begin, stance.end, other_is_lower, [&](int begin, int end) {
      if (!other_is_lower(begin)) longest = std::max(longest, (end - begin) * frame_time());
    });
    return longest >= kAlone;
  }

  void add_steps(int foot) {
    for (const ContactPhase& stance : contacts_.soles[static_cast<std::size_t>(foot)]) {
      if (stance.support < kLowestSurface * scale_ || !carries(foot, stance)) continue;
      RaisedRest rest{RestKind::kStep, {stance.begin, stance.end}, floor_ + stance.support, {}};
      add_sole(foot, rest.frames, scale_, feet_, rest.outline);
      rests_.push_back(std::move(rest));
    }
  }

  // Whether the body sits in a frame: its thighs are level, and its hips are behind the feet.
  [[nodiscard]] bool sits(int frame) const {
    const Vector3d hips = place(Bone::kHips, frame);
    const double height = hips.z() - floor_;
    if (height < kLowestSeat * scale_ || height > 0.8 * kUsualSourceLeg * scale_) return false;
    double nearest = 1e9;
    for (const Side side : kSides) {
      const Vector3d thigh = place(side_bone(side, LimbBone::kLeg), frame) -
                             place(side_bone(side, LimbBone::kUpLeg), frame);
      if (!(std::abs(thigh.z()) <= kLevelThigh * thigh.norm())) return false;
      const Vector3d foot = place(side_bone(side, LimbBone::kFoot), frame);
      nearest = std::min(nearest, (foot - hips).head<2>().norm());
    }
    return nearest >= kBehindFeet * scale_;
  }

  [[nodiscard]] double speed(Bone bone, int frame) const {
    const int from = std::max(0, frame - 1), to = std::min(human_.frame_count - 1, frame + 1);
    return (place(bone, to) - place(bone, from)).norm() / (frame_time() * std::max(1, to - from));
  }

  void add_seats() {
    if (!human_.has(Bone::kHips) || feet_.foot_count < 2) return;
    const auto rests = [&](int frame) {
      return speed(Bone::kHips, frame) < kStillSpeed * scale_ && sits(frame);
    };
    for_each_run(0, human_.frame_count, rests, [&](int begin, int end) {
      if (!rests(begin) || (end - begin) * frame_time() < kShortestRest) return;
      std::vector<double> heights;
      Vector2d middle = Vector2d::Zero();
      for (int frame = begin; frame < end; ++frame) {
        const Vector3d hips = place(Bone::kHips, frame);
        heights.push_back(hips.z() - kSeatDepth * scale_);
        middle += hips.head<2>() / (end - begin);
      }
      RaisedRest rest{RestKind::kSeat, {begin, end}, median_in_place(heights), {}};
      add_square(middle, kHalfSeat * scale_, rest.outline);
      rests_.push_back(std::move(rest));
    });
  }

  // Grows a run of frames in which the hand stays near its place in the first one.
  [[nodiscard]] int end_of_stay(Bone hand, int begin) const {
    const Vector3d first = place(hand, begin);
    int end = begin;
    while (end < human_.frame_count && (place(hand, end) - first).norm() <= kHandStays * scale_) {
      ++end;
    }
    return end;
  }

  void add_hands(Side side) {
    const Bone hand = side_bone(side, LimbBone::kHand), arm = side_bone(side, LimbBone::kArm);
    if (!human_.has(hand) || !human_.has(arm)) return;
    for (int begin = 0; begin < human_.frame_count;) {
      const int end = end_of_stay(hand, begin);
      const Vector3d at = place(hand, begin);
      Eigen::AlignedBox3d shoulder;
      for (int frame = begin; frame < end; ++frame) shoulder.extend(place(arm, frame));
      const bool is_held = (end - begin) * frame_time() >= kShortestRest &&
                           shoulder.diagonal().norm() >= kShoulderMoves * scale_ &&
                           at.z() < shoulder.min().z();
      const double height = at.z() - kHandDepth * scale_;
      if (is_held && height - floor_ >= kLowestHand * scale_) {
        RaisedRest rest{RestKind::kHand, {begin, end}, height, {}};
        add_square(at.head<2>(), kHalfHand * scale_, rest.outline);
        rests_.push_back(std::move(rest));
      }
      begin = is_held ? end : begin + 1;
    }
  }

  static void add_square(const Vector2d& middle, double half, std::vector<Vector2d>& outline) {
    for (const double x : {-half, half}) {
      for (const double y : {-half, half}) outline.push_back(middle + Vector2d(x, y));
    }
  }

  const HumanClip& human_;
  const SourceFeet& feet_;
  const ContactPlan& contacts_;
  const double scale_, floor_;
  std::vector<RaisedRest> rests_;
};

}  // namespace

std::vector<RaisedRest> find_raised_rests(const RestingHuman& of) {
  return RestFinder(of).run();
}

std::vector<Footing> find_footings(const RestingHuman& of) {
  std::vector<Footing> footings;
  std::vector<Vector2d> outline;
  for (int foot = 0; foot < of.feet.foot_count; ++foot) {
    for (const ContactPhase& stance : of.contacts.phases[static_cast<std::size_t>(foot)]) {
      outline.clear();
      add_sole(foot, {stance.begin, stance.end}, of.contacts.scale, of.feet, outline);
      for (const Vector2d& point : outline) {
        footings.push_back({point, floor_height(of.contacts) + stance.support});
      }
    }
  }
  return footings;
}

}  // namespace retarget
