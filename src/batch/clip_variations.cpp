#include "batch/clip_variations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "retarget/option_name.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Random numbers that are equal on every machine: SplitMix64 (Steele, Lea and Flood, 2014), seeded by
// a hash of a text (FNV-1a).
class ChangeDraw {
 public:
  explicit ChangeDraw(std::string_view text) {
    for (const char letter : text) {
      state_ = (state_ ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
    }
  }

  // A number between two others, with three digits.
  std::string between(double low, double high) {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94d049bb133111ebULL;
    mixed ^= mixed >> 31U;
    const double share = static_cast<double>(mixed >> 11U) * 0x1p-53;
    return fmt::format("{:.3f}", low + share * (high - low));
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

std::string scaled(double value, double least, double most, ChangeDraw& draw, double low,
                   double high) {
  const double factor = parse_number<double>(draw.between(low, high)).value_or(1.0);
  return fmt::format("{:.3f}", std::clamp(factor * value, least, most));
}

// SolveOptions::terrain with other sizes; the least and most are within those that it accepts.
std::string varied_terrain(const std::string& terrain, ChangeDraw& draw) {
  constexpr std::string_view kStairs = "stairs:", kSlope = "slope:";
  if (terrain.starts_with(kSlope)) {
    const double degrees = parse_number<double>(terrain.substr(kSlope.size())).value_or(1.0);
    return std::string(kSlope) + scaled(degrees, 0.5, 30.0, draw, 0.5, 1.5);
  }
  const std::size_t by = terrain.find('x');
  const std::size_t end = std::min(terrain.find('x', by + 1), terrain.size());
  const auto number = [&](std::size_t from, std::size_t to) {
    return parse_number<double>(std::string_view(terrain).substr(from, to - from)).value_or(0.1);
  };
  const double rise = number(kStairs.size(), by), tread = number(by + 1, end);
  const std::string changed_rise = scaled(rise, 0.005, 0.5, draw, 0.75, 1.25);
  const std::string changed_tread = scaled(tread, 0.1, 2.0, draw, 0.75, 1.25);
  return std::string(kStairs) + changed_rise + "x" + changed_tread + terrain.substr(end);
}

std::string drawn_changes(const SolveOptions& options, ChangeDraw draw) {
  if (!options.terrain.empty()) return "terrain=" + varied_terrain(options.terrain, draw);
  if (options.object_tracks.empty()) return "terrain-scale=z=" + draw.between(0.8, 1.2);
  const std::string x = draw.between(-0.1, 0.1), y = draw.between(-0.1, 0.1);
  return fmt::format("object-shift={},{},0 object-scale={}", x, y, draw.between(0.85, 1.15));
}

void apply_change(std::string_view name, const std::string& value, SolveOptions& options) {
  if (name == "terrain") options.terrain = value;
  if (name == "terrain-scale") options.terrain_scale = value;
  if (name == "object-shift") options.object_shift = value;
  if (name == "object-scale") {
    options.object_scale = parse_number<double>(value).value_or(options.object_scale);
  }
}

}  // namespace

Result<std::vector<BatchInput>> with_variations(std::vector<BatchInput> inputs, int count, int seed,
                                                const SolveOptions& options) {
  if (options.scene.empty() && options.terrain.empty()) {
    return usage_failure(RETARGET_OPTION("variants") " requires " RETARGET_OPTION(
                             "scene") " or " RETARGET_OPTION("terrain"),
                         "variations differ in their scenes");
  }
  const std::size_t originals = inputs.size();
  inputs.reserve(originals * (1 + static_cast<std::size_t>(count)));
  for (std::size_t i = 0; i < originals; ++i) {
    for (int number = 1; number <= count; ++number) {
      BatchInput varied = inputs[i];
      if (varied.variant.source.empty()) varied.variant.source = varied.relative;
      varied.variant.varied_of = varied.relative;
      varied.variant.changes = drawn_changes(
          options, ChangeDraw(fmt::format("{}\n{}\n{}", seed, varied.relative, number)));
      varied.relative = suffixed_name(varied.relative, fmt::format("_v{}", number));
      inputs.push_back(std::move(varied));
    }
  }
  return inputs;
}

void apply_changes(const std::string& changes, SolveOptions& options) {
  const std::string_view view = changes;
  for (std::size_t begin = 0; begin < view.size();) {
    const std::size_t end = std::min(view.find(' ', begin), view.size());
    const std::string_view change = view.substr(begin, end - begin);
    const std::size_t equals = std::min(change.find('='), change.size());
    const std::string_view value = change.substr(std::min(equals + 1, change.size()));
    apply_change(change.substr(0, equals), std::string(value), options);
    begin = end + 1;
  }
}

}  // namespace retarget
