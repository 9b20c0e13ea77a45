#include "human/gait/source_jumps.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "retarget/human.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;

constexpr std::array kThighs = {Bone::kLeftUpLeg, Bone::kRightUpLeg};

double angle_of_step(const Quaterniond& from, const Quaterniond& to) {
  return log_so3(from.conjugate() * to).norm();
}

// Largest angle by which a thigh turns relative to the hips.
double turn_of_thighs(const HumanPose& from, const HumanPose& to, const HumanClipInfo& info) {
  double largest = 0.0;
  for (const Bone thigh : kThighs) {
    if (!info.has(thigh)) continue;
    const auto local = [thigh](const HumanPose& pose) {
      return Quaterniond(pose[Bone::kHips].rotation.conjugate() * pose[thigh].rotation);
    };
    largest = std::max(largest, angle_of_step(local(from), local(to)));
  }
  return largest;
}

// Angle by which the hips turn. Rotations that were computed from positions are noisy: there, a
// whole body turns.
double turn_of_hips(const HumanPose& from, const HumanPose& to, const HumanClipInfo& info,
                    bool of_positions) {
  const auto turn = [&](Bone bone) {
    return angle_of_step(from[bone].rotation, to[bone].rotation);
  };
  const double hips = turn(Bone::kHips);
  return of_positions && info.has(Bone::kSpine2) ? std::min(hips, turn(Bone::kSpine2)) : hips;
}

constexpr std::size_t kAround = 2;  // Steps to either side.

// Whether a step is an isolated jump. A frame of another pose is two such steps in a row.
bool is_jump(const std::vector<double>& rates, std::size_t step, double limit) {
  constexpr double kIsolated = 3.0;
  if (!(rates[step] > limit)) return false;
  std::vector<double> around;
  const std::size_t first = step < kAround ? 0 : step - kAround;
  for (std::size_t i = first; i < rates.size() && i <= step + kAround; ++i) {
    if (i != step) around.push_back(rates[i]);
  }
  std::ranges::sort(around, std::greater<>());
  return around.size() < 2 || rates[step] > kIsolated * around[1];
}

// By step.
struct StepRates {
  std::vector<double> speeds, turns, thighs;
};

StepRates rates_of_steps(HumanPoser& poser, FrameRange part, int stride, bool thighs) {
  StepRates rates;
  const HumanClipInfo info = poser.info();
  const double fps = info.rate.fps() / stride;
  HumanPose before, now;
  poser.pose(part.begin, before);
  for (int frame = part.begin + stride; frame < part.end; frame += stride) {
    poser.pose(frame, now);
    const Eigen::Vector3d step = now[Bone::kHips].translation - before[Bone::kHips].translation;
    rates.speeds.push_back(fps * step.norm());
    rates.turns.push_back(fps * turn_of_hips(before, now, info, !thighs));
    rates.thighs.push_back(thighs ? fps * turn_of_thighs(before, now, info) : 0.0);
    std::swap(before, now);
  }
  return rates;
}

}  // namespace

std::vector<std::string> SourceJumps::texts() const {
  std::vector<std::string> texts;
  if (hips_speed > 0.0) {
    texts.push_back(fmt::format("the hips move at {} m/s", number_text(hips_speed, 1)));
  }
  if (hips_turn > 0.0) {
    texts.push_back(fmt::format("the hips turn at {} rad/s", number_text(hips_turn, 0)));
  }
  if (thigh_turn > 0.0) {
    texts.push_back(fmt::format("the thighs turn at {} rad/s", number_text(thigh_turn, 0)));
  }
  return texts;
}

SourceJumps find_source_jumps(HumanPoser& poser, FrameRange part, bool thighs) {
  constexpr double kFastestHips = 10.0;                        // m/s
  constexpr double kFastestTurn = 20.0, kFastestThigh = 40.0;  // rad/s
  constexpr double kHighestRate = 120.0;                       // Steps per second.
  SourceJumps found;
  const HumanClipInfo info = poser.info();
  if (!info.has(Bone::kHips) || part.end - part.begin < 2) return found;
  const int stride = std::max(1, static_cast<int>(std::lround(info.rate.fps() / kHighestRate)));
  // The steps around the part show whether its first and last steps are isolated.
  const int around = static_cast<int>(kAround) * stride;
  const int before = std::min(around, part.begin / stride * stride);
  const FrameRange seen{part.begin - before, std::min(part.end + around, info.frame_count)};
  const StepRates rates = rates_of_steps(poser, seen, stride, thighs);
  for (std::size_t step = 0; step < rates.speeds.size(); ++step) {
    const int frame = seen.begin + (static_cast<int>(step) + 1) * stride;
    if (frame <= part.begin || frame >= part.end) continue;
    bool jumps = false;
    const auto check = [&](const std::vector<double>& values, double limit, double& largest) {
      if (!is_jump(values, step, limit)) return;
      largest = std::max(largest, values[step]);
      jumps = true;
    };
    check(rates.speeds, kFastestHips, found.hips_speed);
    check(rates.turns, kFastestTurn, found.hips_turn);
    check(rates.thighs, kFastestThigh, found.thigh_turn);
    if (!jumps) continue;
    if (found.frames == 0) found.first = frame;
    ++found.frames;
  }
  return found;
}

}  // namespace retarget
