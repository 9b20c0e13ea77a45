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

/// Scales of lengths and speeds relative to a G1. Speeds scale with the square root of the size
/// (Froude similarity).
struct BodySizes {
  double length = 1.0, speed = 1.0;

  /// @param size  see body_size().
  explicit BodySizes(double size) : length(size), speed(std::sqrt(size)) {}
  /// Largest distance between a lifted body and the links that carry it, metres.
  [[nodiscard]] double carry_reach() const { return 0.04 * length; }
};

/// Positions of all support points at uniform samples, and their contacts. A point may be a contact
/// if it is lower than 2 cm and slower than 0.5 m/s at the sample or at most 1/30 s before or
/// after, for a robot of a G1's size (docs/dynamics.md).
class SupportTracks {
 public:
  /// @param points  must outlive this object.
  /// @param rate    samples per second.
  SupportTracks(const std::vector<SupportPoint>& points, std::size_t samples, double rate);

  /// Stores the positions at a sample. Set all samples before find_contacts().
  void set(std::size_t sample, const TreeState& state);

  /// Finds the contacts with the floor.
  /// @param floor  height of the floor, metres.
  void find_contacts(double floor, const BodySizes& sizes);
  /// Adds the contacts with bodies of the scene. A point that touches both keeps its contact with
  /// the floor.
  /// @param frame_of  returns the frame of the scene for a sample.
  void find_contacts(const SceneSupports& scene, const std::function<int(std::size_t)>& frame_of,
                     const BodySizes& sizes);

  [[nodiscard]] const std::vector<SupportPoint>& points() const { return *points_; }
  [[nodiscard]] std::size_t sample_count() const { return samples_; }
  [[nodiscard]] double rate() const { return rate_; }
  /// The lowest point of a support point's sphere, world, metres.
  [[nodiscard]] const Eigen::Vector3d& at(std::size_t sample, std::size_t point) const {
    return places_[sample * points_->size() + point];
  }
  [[nodiscard]] std::span<const Eigen::Vector3d> at(std::size_t sample) const {
    return std::span(places_).subspan(sample * points_->size(), points_->size());
  }
  /// The centre of a support point's sphere, world, metres.
  [[nodiscard]] Eigen::Vector3d centre(std::size_t sample, std::size_t point) const;
  /// The body of the scene that a point touches; empty: the floor, or no contact.
  [[nodiscard]] std::optional<std::size_t> body_under(std::size_t sample, std::size_t point) const;
  /// Position and normal of a contact.
  /// @param scene  the scene of find_contacts(); may be null for a contact with the floor.
  /// @param frame  frame of the scene.
  [[nodiscard]] ContactPlace place(std::size_t sample, std::size_t point,
                                   const SceneSupports* scene, int frame) const;
  /// The contacts at a sample, reduced to the outermost ones (keep_outermost).
  void list_contacts(std::size_t sample, std::vector<int>& chosen) const;

 private:
  // The surface that a point touches: none, the floor, or kFirstBody + i for body i of the scene.
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

/// Median height of the soles while they stand, metres. A sole stands while it is level, slow and
/// from 6 cm below to 8 cm above height 0 (for a robot of a G1's size). 0 if the soles stand for
/// less than half a second in total.
[[nodiscard]] double standing_height(const SupportTracks& tracks, const BodySizes& sizes);

/// Median height of the lowest level on which soles stand for half a second in total, at any
/// distance from height 0, metres. standing_height() if there is no such level, or if the body also
/// moves far below it for a tenth of a second.
[[nodiscard]] double lowest_standing_height(const SupportTracks& tracks, const BodySizes& sizes);

}  // namespace retarget
