#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <vector>

#include "live/live_sample.h"

namespace retarget {

/// The events of a stream, in order of time.
struct StreamIncident {
  enum class Kind : unsigned char { kFrame, kStop, kNewBody } kind = Kind::kFrame;
  double at = 0.0;     ///< Local time.
  double until = 0.0;  ///< For kStop: end of the pause of the process.
  HumanFrame frame;    ///< For kFrame.
};

/// A stream of a few seconds with random faults: jitter, loss, bursts, pauses, drifting and
/// stepping clocks, teleports, invalid poses and values, other bodies, a stopped process.
struct RandomStream {
  LiveOptions options;
  std::vector<StreamIncident> incidents;
  double end = 0.0;
};

/// Probabilities of one kind of stream.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : random_(seed) {}
  bool of(double share) { return real(0.0, 1.0) < share; }
  double real(double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random_);
  }
  int whole(int low, int high) {
    return low + static_cast<int>(real(0.0, 1.0) * (high - low + 1) * 0.9999999);
  }
  template <typename Value>
  Value one(std::initializer_list<Value> values) {
    return values.begin()[whole(0, static_cast<int>(values.size()) - 1)];
  }
  Eigen::Quaterniond turn(double most) {
    const Eigen::Vector3d axis(real(-1.0, 1.0), real(-1.0, 1.0), real(-1.0, 1.0));
    return Eigen::Quaterniond(Eigen::AngleAxisd(real(-most, most), axis.normalized()));
  }

 private:
  std::mt19937_64 random_;
};

inline LiveOptions random_options(Chance& chance) {
  LiveOptions options;
  options.fps = chance.one({25.0, 50.0, 50.0, 50.0, 60.0, 100.0});
  options.delay_s = chance.of(0.2) ? chance.real(0.0, 0.1) : 0.0;
  options.hold_s = chance.one({0.05, 0.2, 2.0});
  if (chance.of(0.15)) options.clock = LiveClock::kArrival;
  if (chance.of(0.3)) {
    options.limits.root_speed = chance.real(1.0, 10.0);
    options.limits.turn_speed = chance.real(2.0, 20.0);
    options.limits.joint_acceleration = chance.real(20.0, 600.0);
    options.limits.root_acceleration = chance.real(5.0, 100.0);
    options.limits.turn_acceleration = chance.real(20.0, 400.0);
    options.limits.resume_joint_speed = chance.real(0.3, 3.0);
    options.limits.resume_root_speed = chance.real(0.1, 1.0);
    options.limits.resume_s = chance.real(0.2, 2.0);
  }
  return options;
}

inline void spoil(Chance& chance, HumanPose& pose) {
  const auto bone = kAllBones[static_cast<std::size_t>(
      chance.whole(0, static_cast<int>(std::size(kAllBones)) - 1))];
  switch (chance.whole(0, 3)) {
    case 0:
      pose[bone].translation.x() = std::nan("");
      break;
    case 1:
      pose[bone].rotation.coeffs().setZero();
      break;
    case 2:
      pose[bone].translation.setConstant(chance.real(-1e9, 1e9));
      break;
    default:
      for (const Bone any : kAllBones) pose[any].rotation = chance.turn(3.0);
  }
}

/// @param human  the motion to send, starting at a random frame.
inline RandomStream random_stream(std::uint64_t seed, const HumanClip& human) {
  Chance chance(seed);
  RandomStream stream;
  stream.options = random_options(chance);
  const double fps =
      chance.of(0.5) ? chance.one({24.0, 30.0, 50.0, 60.0, 100.0, 120.0}) : chance.real(8.0, 200.0);
  const double rate = chance.of(0.5) ? 1.0 : std::exp2(chance.real(-1.0, 1.0));
  const double jitter = chance.one({0.0, 0.001, 0.01, 0.06});
  const double loss = chance.one({0.0, 0.0, 0.1, 0.5});
  const double trouble = chance.one({0.0, 0.01, 0.05});  // Probability per frame and kind of fault.
  stream.end = chance.real(0.6, 1.6);
  double stamp_shift = chance.real(-1e4, 1e4), held_until = 0.0, silent_until = 0.0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  int pose = chance.whole(0, human.frame_count - 1);
  for (int i = 0; i / fps < stream.end; ++i) {
    const double time = i / fps;
    if (chance.of(trouble))
      stamp_shift += chance.one({-1.0, 1.0}) * std::pow(10.0, chance.real(-2.0, 1.0));
    if (chance.of(trouble)) held_until = time + chance.real(0.05, 0.6);
    if (chance.of(trouble)) silent_until = time + chance.real(0.05, 0.8);
    if (chance.of(trouble)) {
      place += Eigen::Vector3d(chance.real(-8.0, 8.0), chance.real(-8.0, 8.0), 0.0);
      turn = turn * chance.turn(3.0);
    }
    if (chance.of(0.3 * trouble)) {
      stream.incidents.push_back(
          {StreamIncident::Kind::kStop, time, time + chance.real(0.01, 1.0), {}});
    }
    if (chance.of(0.05 * trouble)) {
      stream.incidents.push_back({StreamIncident::Kind::kNewBody, time, 0.0, {}});
    }
    pose = (pose + (chance.of(trouble) ? chance.whole(0, 40) : 1)) % human.frame_count;
    if (time < silent_until || chance.of(loss)) continue;
    const double late = chance.real(0.0, jitter);
    const double arrival = std::max(time + late, held_until);
    HumanFrame frame{rate * time + stamp_shift, human.frame(pose)};
    for (const Bone bone : kAllBones) {
      Pose& of_bone = frame.world_from_bone[bone];
      of_bone = {turn * of_bone.rotation, turn * of_bone.translation + place};
    }
    if (chance.of(trouble)) spoil(chance, frame.world_from_bone);
    if (chance.of(0.1 * trouble)) frame.time = chance.one({0.0, 1e12, -1e12, std::nan("")});
    stream.incidents.push_back({StreamIncident::Kind::kFrame, arrival, 0.0, frame});
    if (chance.of(trouble)) stream.incidents.push_back(stream.incidents.back());
  }
  std::ranges::stable_sort(stream.incidents, {}, &StreamIncident::at);
  return stream;
}

}  // namespace retarget
