#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace retarget {

/// A frame of an MVNX file as its attributes `time` and `index` place it.
struct MvnxStamp {
  std::optional<double> time;   ///< Milliseconds, rounded or truncated.
  std::optional<double> index;  ///< Number of the frame.
  std::size_t line = 0;
};

/// A contradiction between the frames of an MVNX file and even frames at its rate.
struct MvnxClockFault {
  std::string message;
  std::size_t line = 0;  ///< 0: the whole file.
};

/// Compares the stamps of frames with even frames. Times and indices count if all frames have them
/// and they are not all equal.
/// @param fps  stated rate, Hz; nothing: only the evenness is checked.
/// @return empty without a contradiction.
[[nodiscard]] std::optional<MvnxClockFault> mvnx_clock_fault(const std::vector<MvnxStamp>& stamps,
                                                             const std::optional<double>& fps);

}  // namespace retarget
