#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "judge/quality/report_parts.h"

namespace retarget {

/// Motion and height of the bodies in contact, over all contacts of a clip.
struct ContactMotion {
  std::vector<double> slips;  ///< Horizontal speed between two frames, m/s.
  std::vector<double>
      drifts;  ///< By contact: maximum horizontal distance from the median position, metres.
  std::vector<double> heights;  ///< By frame, metres.

  /// Adds slips and drift of one contact. Speeds above 0.1 m/s are faults.
  /// @param places  world positions of the body in contact, by frame starting at `begin`, metres;
  ///   at least one.
  void add(const std::vector<Eigen::Vector3d>& places, int begin, double fps,
           const std::string& name, FaultList& slipping);
};

}  // namespace retarget
