#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "judge/quality/report_parts.h"

namespace retarget {

/// Samples of slip, drift and height over all contacts of a clip.
struct ContactMotion {
  /// Horizontal speed between frames that are a difference_stride() apart, m/s.
  std::vector<double> slips;
  /// Maximum horizontal distance of each contact from its median position, metres.
  std::vector<double> drifts;
  std::vector<double> heights;  ///< Heights by contact and frame, metres; filled by the callers.

  /// Adds the slips and the drift of one contact. Speeds above 0.1 m/s are faults.
  /// @param places    positions of the contact by frame from `begin`, world, metres; at least one.
  /// @param name      body or joint for the faults.
  /// @param slipping  receives the faults.
  void add(const std::vector<Eigen::Vector3d>& places, int begin, double fps,
           const std::string& name, FaultList& slipping);
};

}  // namespace retarget
