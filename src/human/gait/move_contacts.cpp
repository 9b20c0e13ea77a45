#include "human/gait/move_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "human/gait/body_joint.h"
#include "human/gait/frame_runs.h"
#include "human/gait/limb_mover.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Track = std::vector<Vector3d>;

constexpr double kHandFade = 0.5;    // Seconds in which a hand leaves the body's displacement.
constexpr double kHalfWindow = 0.3;  // Seconds; half the window that smooths the body.
// A foot is over the edge of a step after this share of its swing.
constexpr double kHighAfter = 0.6;
constexpr double kReachShare = 0.985;  // Of the leg's length.
constexpr double kNothing = 1e-9;

std::size_t at_frame(int frame) {
  return static_cast<std::size_t>(frame);
}

// Displacement and turn of a foot in all frames.
struct FootTrack {
  Track offsets;
  std::vector<Quaterniond> turns;
};

FootTrack foot_track(const std::vector<ContactMove>& moves, int count) {
  FootTrack track{Track(at_frame(count), Vector3d::Zero()),
                  std::vector<Quaterniond>(at_frame(count), Quaterniond::Identity())};
  const auto hold = [&](int begin, int end, const Vector3d& offset, const Quaterniond& turn) {
    std::fill(track.offsets.begin() + begin, track.offsets.begin() + end, offset);
    std::fill(track.turns.begin() + begin, track.turns.begin() + end, turn);
  };
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const ContactMove& move = moves[i];
    std::ranges::copy(move.offsets, track.offsets.begin() + move.begin);
    std::fill(track.turns.begin() + move.begin, track.turns.begin() + move.end, move.turn);
    if (i == 0) {
      hold(0, move.begin, move.offsets.front(), move.turn);
      continue;
    }
    const ContactMove& before = moves[i - 1];
    const Vector3d from = before.offsets.back(), to = move.offsets.front();
    const double length = move.begin - before.end + 1.0;
    for (int frame = before.end; frame < move.begin; ++frame) {
      const double time = (frame - before.end + 1) / length, share = quintic_step(time);
      const double height = to.z() > from.z() ? quintic_step(time / kHighAfter)
                                              : quintic_step(1.0 - (1.0 - time) / kHighAfter);
      Vector3d& offset = track.offsets[at_frame(frame)];
      offset = from + share * (to - from);
      offset.z() = from.z() + height * (to.z() - from.z());
      track.turns[at_frame(frame)] =
          before.turn * exp_so3(share * log_so3(before.turn.conjugate() * move.turn));
    }
  }
  if (!moves.empty()) {
    hold(moves.back().end, count, moves.back().offsets.back(), moves.back().turn);
  }
  return track;
}

class ContactMover {
 public:
  ContactMover(Clip& clip, int first, const Calibration& calibration, const ContactMoves& moves)
      : clip_(clip),
        first_(first),
        calibration_(calibration),
        moves_(moves),
        count_(clip.frame_count() - first) {}

  void run() {
    const int moved = body_joint(clip_.skeleton(), calibration_);
    if (moved < 0 || count_ <= 0 || moves_.empty()) return;
    for (std::size_t foot = 0; foot < 2; ++foot) {
      feet_[foot] = foot_track(moves_.feet[foot], count_);
    }
    find_body();
    apply(moved);
  }

 private:
  [[nodiscard]] double frame_time() const { return clip_.rate().frame_time(); }

  void find_body() {
    body_.assign(at_frame(count_), Vector3d::Zero());
    int known = 0;
    for (std::size_t foot = 0; foot < 2; ++foot) {
      if (moves_.feet[foot].empty()) continue;
      ++known;
      for (int i = 0; i < count_; ++i) body_[at_frame(i)] += feet_[foot].offsets[at_frame(i)];
    }
    if (known == 2) {
      for (Vector3d& offset : body_) offset *= 0.5;
    }
    for (const ContactMove& move : moves_.trunk) {
      std::ranges::copy(move.offsets, body_.begin() + move.begin);
    }
    body_ = smoothed(body_);
    lower_to_legs();
  }

  // Excess height of a hip above the reach of its standing leg, metres.
  [[nodiscard]] double excess(const HumanPose& pose, Side side, const Vector3d& ankle_offset,
                              const Vector3d& body) const {
    const auto place = [&](LimbBone part) -> const Vector3d& {
      return pose[side_bone(side, part)].translation;
    };
    const Vector3d& hip = place(LimbBone::kUpLeg);
    const Vector3d& knee = place(LimbBone::kLeg);
    const Vector3d& ankle = place(LimbBone::kFoot);
    const double length = (knee - hip).norm() + (ankle - knee).norm();
    const double reach = std::max((ankle - hip).norm(), kReachShare * length);
    const Vector3d leg = ankle + ankle_offset - hip - body;
    const double aside = leg.head<2>().norm();
    if (aside >= reach) return 0.0;
    return std::max(0.0, -leg.z() - std::sqrt(reach * reach - aside * aside));
  }

  // Lowers the body smoothly where standing legs could not reach the ground. The mean of the
  // greatest excess around each frame is never less than the excess itself.
  void lower_to_legs() {
    HumanPoser poser(clip_, calibration_);
    HumanPose pose;
    std::vector<double> high(at_frame(count_), 0.0);
    for (std::size_t foot = 0; foot < 2; ++foot) {
      for (const ContactMove& move : moves_.feet[foot]) {
        for (int i = move.begin; i < move.end; ++i) {
          poser.pose(first_ + i, pose);
          const double found = excess(pose, kSides[foot], move.offsets[at_frame(i - move.begin)],
                                      body_[at_frame(i)]);
          high[at_frame(i)] = std::max(high[at_frame(i)], found);
        }
      }
    }
    const int half = frames_in(kHalfWindow, frame_time());
    Track lower(at_frame(count_), Vector3d::Zero());
    for (int i = 0; i < count_; ++i) {
      const auto begin = high.begin() + std::max(0, i - half);
      const auto end = high.begin() + std::min(count_, i + half + 1);
      lower[at_frame(i)].z() = -*std::max_element(begin, end);
    }
    lower = smoothed(lower);
    for (int i = 0; i < count_; ++i) body_[at_frame(i)] += lower[at_frame(i)];
  }

  // Means with biweight weights.
  [[nodiscard]] Track smoothed(const Track& raw) const {
    const int half = frames_in(kHalfWindow, frame_time());
    Track means;
    for (int i = 0; i < count_; ++i) {
      Vector3d sum = Vector3d::Zero();
      double weights = 0.0;
      for (int step = -half; step <= half; ++step) {
        const double u = step / (half + 1.0), left = 1.0 - u * u;
        sum += left * left * raw[at_frame(std::clamp(i + step, 0, count_ - 1))];
        weights += left * left;
      }
      means.emplace_back(sum / weights);
    }
    return means;
  }

  // Displacements of a hand: as given in contact, otherwise those of the body.
  [[nodiscard]] Track hand_offsets(const std::vector<ContactMove>& moves) const {
    Track offsets = body_;
    const int fade = frames_in(kHandFade, frame_time());
    std::vector<double> free(at_frame(count_), 1.0);
    for (const ContactMove& move : moves) {
      const auto pull = [&](int frame, const Vector3d& to, double share) {
        if (frame < 0 || frame >= count_ || 1.0 - share >= free[at_frame(frame)]) return;
        free[at_frame(frame)] = 1.0 - share;
        offsets[at_frame(frame)] = body_[at_frame(frame)] + share * (to - body_[at_frame(frame)]);
      };
      for (int i = 1; i < fade; ++i) {
        const double share = quintic_step(1.0 - static_cast<double>(i) / fade);
        pull(move.begin - i, move.offsets.front(), share);
        pull(move.end - 1 + i, move.offsets.back(), share);
      }
      for (int i = move.begin; i < move.end; ++i)
        pull(i, move.offsets[at_frame(i - move.begin)], 1.0);
    }
    return offsets;
  }

  void apply(int moved) {
    const auto legs = find_legs(clip_.skeleton(), calibration_);
    const auto arms = find_arms(clip_.skeleton(), calibration_);
    std::array<std::optional<LimbMover>, 2> limb_movers, arm_movers;
    std::array<Track, 2> hands;
    for (std::size_t side = 0; side < 2; ++side) {
      hands[side] = hand_offsets(moves_.hands[side]);
      if (legs[side]) {
        limb_movers[side].emplace(clip_, calibration_, *legs[side],
                                  side_bone(kSides[side], LimbBone::kLeg));
      }
      if (arms[side] && !moves_.hands[side].empty()) {
        arm_movers[side].emplace(clip_, calibration_, *arms[side],
                                 side_bone(kSides[side], LimbBone::kForeArm));
      }
    }
    for (int i = 0; i < count_; ++i) {
      const Vector3d& body = body_[at_frame(i)];
      if (body.norm() > kNothing) move_body(clip_, first_ + i, calibration_, moved, body);
      for (std::size_t side = 0; side < 2; ++side) {
        const Quaterniond& turn = feet_[side].turns[at_frame(i)];
        const Vector3d foot = feet_[side].offsets[at_frame(i)] - body;
        const bool moves = foot.norm() > kNothing || turn.vec().norm() > kNothing;
        if (limb_movers[side] && !moves_.feet[side].empty() && moves) {
          limb_movers[side]->move_end(clip_, first_ + i, turn, foot);
        }
        const Vector3d hand = hands[side][at_frame(i)] - body;
        if (arm_movers[side] && hand.norm() > kNothing) {
          arm_movers[side]->move_end(clip_, first_ + i, Quaterniond::Identity(), hand);
        }
      }
    }
  }

  Clip& clip_;
  const int first_;
  const Calibration& calibration_;
  const ContactMoves& moves_;
  const int count_;
  // By frame from first_.
  std::array<FootTrack, 2> feet_;
  Track body_;
};

}  // namespace

bool ContactMoves::empty() const {
  return feet[0].empty() && feet[1].empty() && hands[0].empty() && hands[1].empty() &&
         trunk.empty();
}

void move_contacts(Clip& clip, int first, const Calibration& calibration,
                   const ContactMoves& moves) {
  ContactMover(clip, first, calibration, moves).run();
}

}  // namespace retarget
