#include "refine/fit_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/faults.h"
#include "base/json.h"
#include "base/suggest.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMost = 1e6;

struct Term {
  const char* name;
  bool FitOptions::*on;
};
constexpr std::array kTerms = {Term{"tracking", &FitOptions::tracking},
                               Term{"foot-height", &FitOptions::foot_height},
                               Term{"contact", &FitOptions::contact},
                               Term{"floor", &FitOptions::floor},
                               Term{"self-collision", &FitOptions::self_collision},
                               Term{"smoothness", &FitOptions::smoothness},
                               Term{"speed", &FitOptions::speed}};

struct Weight {
  const char* name;
  double TrackingWeights::*value;
};
constexpr std::array kWeights = {Weight{"hips_position", &TrackingWeights::hips_position},
                                 Weight{"hips_rotation", &TrackingWeights::hips_rotation},
                                 Weight{"torso_rotation", &TrackingWeights::torso_rotation},
                                 Weight{"thigh_position", &TrackingWeights::thigh_position},
                                 Weight{"shank_position", &TrackingWeights::shank_position},
                                 Weight{"thigh_rotation", &TrackingWeights::thigh_rotation},
                                 Weight{"shank_rotation", &TrackingWeights::shank_rotation},
                                 Weight{"foot_position", &TrackingWeights::foot_position},
                                 Weight{"foot_rotation", &TrackingWeights::foot_rotation},
                                 Weight{"upper_arm_position", &TrackingWeights::upper_arm_position},
                                 Weight{"upper_arm_rotation", &TrackingWeights::upper_arm_rotation},
                                 Weight{"forearm_position", &TrackingWeights::forearm_position},
                                 Weight{"forearm_rotation", &TrackingWeights::forearm_rotation},
                                 Weight{"hand_position", &TrackingWeights::hand_position},
                                 Weight{"hand_rotation", &TrackingWeights::hand_rotation},
                                 Weight{"other_position", &TrackingWeights::other_position},
                                 Weight{"other_rotation", &TrackingWeights::other_rotation}};

struct Number {
  const char* name;
  double FitOptions::*value;
  double least = 0.0;
  double most = kMost;
};
constexpr double kAbove0 = 1e-9;
constexpr std::array kNumbers = {
    Number{"foot_height_near", &FitOptions::foot_height_near},
    Number{"foot_height_far", &FitOptions::foot_height_far},
    Number{"foot_height_range", &FitOptions::foot_height_range, kAbove0},
    Number{"contact_weight", &FitOptions::contact_weight},
    Number{"contact_height_weight", &FitOptions::contact_height_weight},
    Number{"sole_floor_weight", &FitOptions::sole_floor_weight},
    Number{"sole_margin", &FitOptions::sole_margin, -1.0, 1.0},
    Number{"body_floor_weight", &FitOptions::body_floor_weight},
    Number{"body_margin", &FitOptions::body_margin, -1.0, 1.0},
    Number{"self_collision_weight", &FitOptions::self_collision_weight},
    Number{"self_collision_margin", &FitOptions::self_collision_margin, -1.0, 1.0},
    Number{"smoothness_leg", &FitOptions::smoothness_leg},
    Number{"smoothness_arm", &FitOptions::smoothness_arm},
    Number{"smoothness_wrist", &FitOptions::smoothness_wrist},
    Number{"smoothness_root_position", &FitOptions::smoothness_root_position},
    Number{"smoothness_root_rotation", &FitOptions::smoothness_root_rotation},
    Number{"smoothing_time", &FitOptions::smoothing_time, 0.0, 10.0},
    Number{"speed_soft", &FitOptions::speed_soft, kAbove0},
    Number{"speed_weight", &FitOptions::speed_weight},
    Number{"speed_most", &FitOptions::speed_most, kAbove0},
    Number{"largest_step", &FitOptions::largest_step, kAbove0},
    Number{"contact_speed", &FitOptions::contact_speed},
    Number{"contact_release_speed", &FitOptions::contact_release_speed},
    Number{"contact_height", &FitOptions::contact_height},
    Number{"contact_release_height", &FitOptions::contact_release_height},
    Number{"contact_time", &FitOptions::contact_time},
    Number{"support_time", &FitOptions::support_time},
    Number{"support_drift", &FitOptions::support_drift},
    Number{"window", &FitOptions::window, 0.1},
    Number{"seam", &FitOptions::seam, 0.0}};

struct Count {
  const char* name;
  int FitOptions::*value;
  int least;
  int most;
};
constexpr std::array kCounts = {
    Count{"iterations", &FitOptions::iterations, 0, 10000},
    Count{"anchor_iterations", &FitOptions::anchor_iterations, 0, 10000},
    Count{"threads", &FitOptions::threads, 0, 1024},
    Count{"decimals", &FitOptions::decimals, 3, 17}};

template <typename Table>
auto find(const Table& table, const std::string& name) {
  return std::ranges::find_if(table, [&](const auto& entry) { return name == entry.name; });
}

const std::vector<std::string>& option_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(std::size(kTerms) + std::size(kWeights) + std::size(kNumbers));
    for (const Term& term : kTerms) all.emplace_back(term.name);
    for (const Weight& weight : kWeights) all.emplace_back(weight.name);
    for (const Number& number : kNumbers) all.emplace_back(number.name);
    for (const Count& count : kCounts) all.emplace_back(count.name);
    return all;
  }();
  return names;
}

void read_number(const Json& json, const std::string& name, double least, double most,
                 double& value, Faults& faults) {
  const double found = json.is_number() ? json.get<double>() : std::nan("");
  if (found >= least && found <= most) {
    value = found;
    return;
  }
  faults.add("\"" + name + "\" must be a number from " + Json(least).dump() + " to " +
             Json(most).dump() + ", found " + short_text(json));
}

void read_count(const Json& json, const Count& count, FitOptions& options, Faults& faults) {
  if (json.is_number_integer()) {
    const auto found = json.get<std::int64_t>();
    if (found >= count.least && found <= count.most) {
      options.*count.value = static_cast<int>(found);
      return;
    }
  }
  faults.add("\"" + std::string(count.name) + "\" must be a whole number from " +
             std::to_string(count.least) + " to " + std::to_string(count.most) + ", found " +
             short_text(json));
}

void read_member(const std::string& name, const Json& json, FitOptions& options, Faults& faults) {
  if (const auto term = find(kTerms, name); term != kTerms.end()) {
    if (json.is_boolean()) {
      options.*term->on = json.get<bool>();
    } else {
      faults.add("\"" + name + "\" must be true or false, found " + short_text(json));
    }
  } else if (const auto weight = find(kWeights, name); weight != kWeights.end()) {
    read_number(json, name, 0.0, kMost, options.weights.*weight->value, faults);
  } else if (const auto number = find(kNumbers, name); number != kNumbers.end()) {
    read_number(json, name, number->least, number->most, options.*number->value, faults);
  } else if (const auto count = find(kCounts, name); count != kCounts.end()) {
    read_count(json, *count, options, faults);
  } else {
    faults.add("there is no option \"" + name + "\"" + faults.suggestion(name, option_names()));
  }
}

}  // namespace

Result<FitOptions> parse_fit_options(std::string_view text, const std::string& file,
                                     FitOptions options) {
  const auto json = parse_json(text, file);
  if (!json) return failure(json.error());
  if (!json->is_object()) {
    return config_failure(file,
                          "the options of a fit must be an object, found " + short_text(*json));
  }
  Faults faults;
  for (const auto& [name, value] : json->items()) read_member(name, value, options, faults);
  if (!faults.empty()) return faults.failure_in(file, "the options of the fit");
  return options;
}

const std::vector<std::string>& fit_term_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(std::size(kTerms));
    for (const Term& term : kTerms) all.emplace_back(term.name);
    return all;
  }();
  return names;
}

Result<void> leave_out_terms(FitOptions& options, std::span<const std::string> names) {
  for (const std::string& name : names) {
    const auto term = find(kTerms, name);
    if (term == kTerms.end()) {
      return usage_failure(
          "a fit has no term \"" + name + "\"" + did_you_mean(name, fit_term_names()),
          "it has " + list_names(fit_term_names()));
    }
    options.*term->on = false;
  }
  return {};
}

}  // namespace retarget
