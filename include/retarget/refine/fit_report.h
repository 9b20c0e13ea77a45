#pragma once

#include <string>
#include <vector>

namespace retarget {

/// How much a term of the fit costs, and where.
struct FitTermReport {
  std::string name;        ///< As in docs/fit.md.
  double before = 0.0;     ///< Mean over frames, of the motion that the fit starts from.
  double after = 0.0;      ///< The same at the end.
  std::vector<int> worst;  ///< Up to five frames where it is worst at the end, worst first, each
                           ///< at least half a second from the others.
};

/// A joint whose motion had to be changed at the end to keep the limits.
struct FitBoundReport {
  std::string joint;
  int frames = 0;        ///< How many frames were changed.
  int worst_frame = 0;   ///< Where it was changed most ...
  double largest = 0.0;  ///< ... and by how much, rad or m.
};

/// What a fit found and what is left.
struct FitReport {
  double floor_height = 0.0;  ///< By how much the targets were lowered, metres.
  bool floor_found = false;   ///< False: no foot of the source stands; the height is a guess.
  int contact_phases = 0;     ///< Of heels and toes.
  std::vector<FitTermReport> terms;
  std::vector<FitBoundReport> bounded;
  std::vector<std::string> notes;  ///< Terms that the robot or the source cannot have, and why.
};

}  // namespace retarget
