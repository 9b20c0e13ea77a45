#include "app/plan/preset.h"

#include <algorithm>
#include <array>

namespace retarget {
namespace {

struct WeightFactor {
  const char* name;
  double FitOptions::*weight;
  double factor;
};

// docs/fit.md, "Motions for policies", has the measurements.
constexpr std::array<WeightFactor, 5> kTrackingFactors = {
    {{"smoothness_leg", &FitOptions::smoothness_leg, 2.0},
     {"smoothness_arm", &FitOptions::smoothness_arm, 2.0},
     {"smoothness_wrist", &FitOptions::smoothness_wrist, 2.0},
     {"smoothness_root_reference", &FitOptions::smoothness_root_reference, 0.0},
     {"smoothness_root_rotation", &FitOptions::smoothness_root_rotation, 2.0}}};

}  // namespace

void apply_preset(const SolveOptions& options, FitOptions& fit) {
  if (options.purpose != Purpose::kTracking) return;
  const FitOptions usual;
  const auto is_given = [&](const char* name) {
    return std::ranges::find(options.fit_given, name) != options.fit_given.end();
  };
  for (const auto& [name, weight, factor] : kTrackingFactors) {
    if (!is_given(name) && options.fit.*weight == usual.*weight) fit.*weight *= factor;
  }
  if (!is_given("dynamics")) fit.dynamics = true;
}

std::string chosen_travel(const SolveOptions& options) {
  if (!options.travel.empty()) return options.travel;
  return options.purpose == Purpose::kTracking ? "auto" : "";
}

}  // namespace retarget
