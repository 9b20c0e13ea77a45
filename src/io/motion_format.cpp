#include "retarget/motion_io.h"

#include <array>

#include "base/suggest.h"

namespace retarget {
namespace {

struct FormatFacts {
  MotionFormat format;
  std::string_view name, ending, long_ending;
};

// in the order of the enumeration
constexpr std::array<FormatFacts, 6> kFormats = {{
    {MotionFormat::kCsv, "csv", ".csv", ".csv"},
    {MotionFormat::kCsvSoma, "csv-soma", ".csv", ".soma.csv"},
    {MotionFormat::kNpzMjlab, "npz-mjlab", ".npz", ".mjlab.npz"},
    {MotionFormat::kNpzBeyondMimic, "npz-beyondmimic", ".npz", ".beyondmimic.npz"},
    {MotionFormat::kPklGmr, "pkl-gmr", ".pkl", ".gmr.pkl"},
    {MotionFormat::kPklPbhc, "pkl-pbhc", ".pkl", ".pbhc.pkl"},
}};

const FormatFacts& facts(MotionFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

}  // namespace

std::string_view format_name(MotionFormat format) {
  return facts(format).name;
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const FormatFacts& each : kFormats) names.emplace_back(each.name);
  return names;
}

Result<MotionFormat> format_from_name(std::string_view name) {
  for (const FormatFacts& each : kFormats) {
    if (each.name == name) return each.format;
  }
  const auto names = format_names();
  return usage_failure(
      "there is no format \"" + std::string(name) + "\"" + did_you_mean(name, names),
      "the formats are " + list_names(names));
}

std::string_view format_ending(MotionFormat format) {
  return facts(format).ending;
}

std::string_view format_long_ending(MotionFormat format) {
  return facts(format).long_ending;
}

}  // namespace retarget
