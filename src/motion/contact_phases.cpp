#include "motion/contact_phases.h"

#include <algorithm>
#include <cmath>

#include "math/statistics.h"

namespace retarget {
namespace {

using Track = std::vector<Eigen::Vector3d>;

// speed of a point in every frame, m/s
std::vector<double> speeds_of(const Track& track, double frame_time) {
  std::vector<double> speeds(track.size(), 0.0);
  if (track.size() < 2) return speeds;
  const std::size_t last = track.size() - 1;
  speeds[0] = ((track[1] - track[0]) / frame_time).norm();
  speeds[last] = ((track[last] - track[last - 1]) / frame_time).norm();
  for (std::size_t i = 1; i < last; ++i) {
    speeds[i] = ((track[i + 1] - track[i - 1]) / (2.0 * frame_time)).norm();
  }
  return speeds;
}

// percentile over frames of the lower of two tracks; an empty track does not count
double low_height(const Track& left, const Track& right, double percentile_rank) {
  std::vector<double> heights;
  const std::size_t frames = std::max(left.size(), right.size());
  heights.reserve(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    heights.push_back(left.empty()    ? right[i].z()
                      : right.empty() ? left[i].z()
                                      : std::min(left[i].z(), right[i].z()));
  }
  return percentile(std::move(heights), percentile_rank);
}

// how far ankles are above the toes of feet that stand
double standing_rise(const std::array<FootTrack, 2>& feet, double toe_height, double frame_time,
                     double scale, const ContactOptions& options) {
  std::vector<double> rises;
  for (const FootTrack& foot : feet) {
    const std::vector<double> speeds = speeds_of(foot.toe, frame_time);
    for (std::size_t i = 0; i < foot.toe.size(); ++i) {
      const double rise = foot.ankle[i].z() - foot.toe[i].z();
      if (speeds[i] < options.begin_speed * scale &&
          foot.toe[i].z() < toe_height + options.begin_height * scale &&
          rise > options.upright_rise * scale) {
        rises.push_back(rise);
      }
    }
  }
  return rises.empty() ? options.usual_rise * scale : median(std::move(rises));
}

std::vector<ContactPhase> phases_of(const FootTrack& foot, const FootContacts& contacts,
                                    const FrameRate& rate, const ContactOptions& options) {
  const std::vector<double> ankle_speeds = speeds_of(foot.ankle, rate.frame_time());
  const std::vector<double> toe_speeds = speeds_of(foot.toe, rate.frame_time());
  const double frames_wanted = options.shortest * rate.fps();
  // a contact of the shortest time counts, however its product with the rate is rounded
  const int shortest = static_cast<int>(std::ceil(frames_wanted - 1e-9 * frames_wanted));

  std::vector<ContactPhase> phases;
  const int frames = static_cast<int>(foot.ankle.size());
  int begin = -1;  // of the contact that lasts
  for (int i = 0; i <= frames; ++i) {
    bool planted = false;
    if (i < frames) {
      double speed = ankle_speeds[i];
      double height = std::abs(foot.ankle[i].z() - contacts.standing_ankle_height);
      if (!foot.toe.empty()) {
        speed = std::max(speed, toe_speeds[i]);
        height = std::max(height, foot.toe[i].z() - contacts.standing_toe_height);
      }
      const bool lasts = begin >= 0;
      planted = lasts ? !(speed > options.end_speed * contacts.scale ||
                          height > options.end_height * contacts.scale)
                      : speed < options.begin_speed * contacts.scale &&
                            height < options.begin_height * contacts.scale;
    }
    if (planted && begin < 0) begin = i;
    if (!planted && begin >= 0) {
      if (i - begin >= shortest) phases.push_back({begin, i});
      begin = -1;
    }
  }
  return phases;
}

}  // namespace

bool FootContacts::planted(int foot, int frame) const {
  const auto& of_foot = phases[foot];
  const auto after = std::ranges::upper_bound(of_foot, frame, {}, &ContactPhase::begin);
  return after != of_foot.begin() && frame < std::prev(after)->end;
}

FootContacts find_contact_phases(const std::array<FootTrack, 2>& feet, double leg_length,
                                 const FrameRate& rate, const ContactOptions& options) {
  FootContacts contacts;
  contacts.scale = leg_length / options.reference_leg;
  const auto& [left, right] = feet;
  if (left.ankle.empty() && right.ankle.empty()) return contacts;
  const double usual_rise = options.usual_rise * contacts.scale;
  if (left.toe.empty() && right.toe.empty()) {
    contacts.standing_ankle_height = low_height(left.ankle, right.ankle, options.floor_percentile);
    contacts.standing_toe_height = contacts.standing_ankle_height - usual_rise;
  } else {
    contacts.standing_toe_height = low_height(left.toe, right.toe, options.floor_percentile);
    contacts.standing_ankle_height =
        contacts.standing_toe_height + standing_rise(feet, contacts.standing_toe_height,
                                                     rate.frame_time(), contacts.scale, options);
  }
  for (int foot = 0; foot < 2; ++foot) {
    contacts.phases[foot] = phases_of(feet[foot], contacts, rate, options);
  }
  return contacts;
}

}  // namespace retarget
