#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quality/fault_list.h"

namespace retarget {

/// How what is in contact moves, and how high it is, in all contacts of a clip.
struct ContactMotion {
  std::vector<double> slips;  ///< Horizontally from a frame to the next, m/s.
  std::vector<double>
      drifts;  ///< By contact: the farthest from its median place, horizontally, metres.
  std::vector<double> heights;  ///< By frame, metres.

  /// Adds slips and the drift of one contact. Steps above 0.1 m/s are faults.
  /// @param places  of what is in contact, by frame from `begin` on, metres, world; one at least.
  void add(const std::vector<Eigen::Vector3d>& places, int begin, double fps,
           const std::string& name, FaultList& slipping);
};

}  // namespace retarget
