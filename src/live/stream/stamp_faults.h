#pragma once

#include <string>

namespace retarget {

/// Detects timestamps that cannot be the times of frames in seconds: constant, falling, or in
/// another unit.
class StampFaults {
 public:
  /// Adds the timestamp of the next frame. @param arrival  seconds, any clock
  /// @return the fault of the latest frames, a sentence; empty: none or not known yet.
  [[nodiscard]] std::string add(double stamp, double arrival);

 private:
  [[nodiscard]] std::string fault(double passed) const;
  void begin(double stamp, double arrival);

  int steps_ = 0, constant_ = 0, falling_ = 0, long_ = 0;
  double first_ = 0.0, last_ = 0.0, arrival_ = 0.0;
  bool has_begun_ = false;
};

}  // namespace retarget
