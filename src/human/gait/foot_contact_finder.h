#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/contact_plan.h"

namespace retarget {

/// Finds the contacts of one foot; the standing heights of the source are known.
class FootContactFinder {
 public:
  /// Finds the supports of both ends while they are slow. Call this first. The arguments must
  /// outlive all later calls.
  void find_stands(const SourceFeet& source, const ContactPlan& plan, const ContactOptions& options,
                   int foot);

  /// Finds raised stances that find_stands omits, because feet in the air look the same. They count
  /// if nothing else supports the body: a slow foot that moves farther than support_drift, as when
  /// a person on a step lifts the heel slowly, and a still toe below a moving heel, as on stairs.
  /// Call this after find_stands of all feet.
  /// @param carries(frame)  whether the body is supported although no part of it is in contact.
  void find_carrying_stances(const std::function<bool(int)>& carries);

  [[nodiscard]] bool stands(int frame, int end) const {
    return stands_on(frame, end) != kUnsupported;
  }
  /// Speed of an end near the floor in m/s, scaled as in ContactOptions; nothing if the end is
  /// higher.
  [[nodiscard]] std::optional<double> speed_near_floor(int frame, int end) const;
  void stand_in(int frame, int end) { stands_on_[end][static_cast<std::size_t>(frame)] = kFloor; }

  void find_contacts_of_ends(std::array<EndContacts, 2>& ends) const;
  void find_whole_foot(std::vector<ContactPhase>& phases);
  void reserve(std::size_t frames);

 private:
  // Support of one end of a foot: the index of a raised stance, or one of these.
  static constexpr int kUnsupported = -2, kFloor = -1;

  // A period in which a whole foot is still above the floor, and the surface height under each end.
  struct RaisedStance {
    int begin = 0, end = 0;
    std::array<double, 2> height{};
  };

  [[nodiscard]] bool has(int end) const { return source_->has(foot_, end); }
  [[nodiscard]] int stands_on(int frame, int end) const {
    return stands_on_[end][static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] const Eigen::Vector3d& place(int frame, int end) const {
    return source_->at(frame, foot_).end(end);
  }
  [[nodiscard]] double height(int frame, int end) const {
    return place(frame, end).z() - standing_->of(end);
  }
  [[nodiscard]] bool is_slow(int frame, int end, double speed) const {
    return source_->speed(frame, foot_, end) <= speed * size_;
  }
  [[nodiscard]] bool lasts(int frames, double seconds) const {
    return frames * source_->frame_time >= seconds - 1e-9;
  }
  [[nodiscard]] double support(int under, int end) const {
    return under == kFloor ? 0.0 : raised_[static_cast<std::size_t>(under)].height[end];
  }
  [[nodiscard]] bool is_still_above_floor(int frame, std::span<const int> ends) const;
  [[nodiscard]] int end_in_place(int first, int end, std::span<const int> ends) const;
  [[nodiscard]] ContactPhase longest_in_place(int begin, int end, std::span<const int> ends) const;
  void stand_on_floor(int end);
  void add_raised_stance(int begin, int end);
  void find_raised_stances();
  void find_carrying_stances(std::span<const int> ends, double min_height, double min_time,
                             const std::function<bool(int)>& carries);
  void stand_raised(int index, int end);
  void add_phases(int end, EndContacts& contacts) const;
  void smooth_levels(const ContactPhase& phase, std::vector<char>& levels) const;

  const SourceFeet* source_ = nullptr;
  const StandingHeights* standing_ = nullptr;
  const ContactOptions* options_ = nullptr;
  double size_ = 1.0;
  int foot_ = 0;
  int frames_ = 0;
  std::vector<RaisedStance> raised_;
  std::array<std::vector<int>, 2> stands_on_;  // Indexed by end and frame.
  std::vector<int> both_stand_on_;             // One per frame: the support that both ends share.
  std::vector<double> heights_;
};

}  // namespace retarget
