#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"

namespace retarget {

/// Scales of lengths and speeds relative to a G1. In a time proportional to the square root of its
/// size, all bodies fall by the same multiple of their lengths.
struct BodySizes {
  double length = 1.0, speed = 1.0;

  explicit BodySizes(double size) : length(size), speed(std::sqrt(size)) {}
  /// Metres between a lifted body and the links that carry it.
  [[nodiscard]] double carry_reach() const { return 0.04 * length; }
};

/// Positions of all support points at uniform samples, and the samples at which each point may be a
/// contact: lower than 2 cm and slower than 0.5 m/s at the sample or 1/30 s before or after, for a
/// robot of the G1's size (docs/dynamics.md).
class SupportTracks {
 public:
  /// @param points  must outlive this object.
  /// @param rate    samples per second.
  SupportTracks(const std::vector<SupportPoint>& points, std::size_t samples, double rate);

  /// Stores the positions at a sample. All samples must be set before contacts are searched.
  void set(std::size_t sample, const TreeState& state);

  void find_contacts(double floor, const BodySizes& sizes);
  /// Adds the contacts with bodies of the scene; the floor has precedence.
  /// @param frame_of  the frame of the scene for each sample.
  void find_contacts(const SceneSupports& scene, const std::function<int(std::size_t)>& frame_of,
                     const BodySizes& sizes);

  [[nodiscard]] const std::vector<SupportPoint>& points() const { return *points_; }
  [[nodiscard]] std::size_t sample_count() const { return samples_; }
  [[nodiscard]] double rate() const { return rate_; }
  /// The lowest position of a point's surface, world, metres.
  [[nodiscard]] const Eigen::Vector3d& at(std::size_t sample, std::size_t point) const {
    return places_[sample * points_->size() + point];
  }
  [[nodiscard]] std::span<const Eigen::Vector3d> at(std::size_t sample) const {
    return std::span(places_).subspan(sample * points_->size(), points_->size());
  }
  /// The centre of a point's ball.
  [[nodiscard]] Eigen::Vector3d centre(std::size_t sample, std::size_t point) const;
  /// The body of the scene that pushes a contact; nothing: the floor does.
  [[nodiscard]] std::optional<std::size_t> body_under(std::size_t sample, std::size_t point) const;
  /// Position of a contact on its surface.
  /// @param scene  with the body under the contact; not read if the floor is.  @param frame  of it.
  [[nodiscard]] ContactPlace place(std::size_t sample, std::size_t point,
                                   const SceneSupports* scene, int frame) const;
  /// The contacts at a sample, reduced to the outermost ones (keep_outermost).
  void list_contacts(std::size_t sample, std::vector<int>& chosen) const;

 private:
  // The surface that may push a point: none, the floor, or that of the body kFirstBody + i.
  using Surface = std::uint16_t;
  static constexpr Surface kNothing = 0, kFloor = 1, kFirstBody = 2;

  void mark(std::size_t sample, std::size_t point, Surface surface);
  [[nodiscard]] Eigen::Vector3d velocity(std::size_t sample, std::size_t point) const;

  const std::vector<SupportPoint>* points_;
  std::size_t samples_;
  double rate_;
  std::vector<Eigen::Vector3d> places_;  // Sample-major.
  std::vector<Surface> pushed_by_;       // Sample-major.
};

/// Median height of the standing soles, metres: flat, slow and near the floor; 0 if they do not
/// stand for at least half a second.
[[nodiscard]] double standing_height(const SupportTracks& tracks, const BodySizes& sizes);

}  // namespace retarget
