#include "retarget/motion_io.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/suggest.h"
#include "options/enum_names.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {
namespace {

struct FormatFacts {
  MotionFormat format;
  std::string_view ending, long_ending;
};

// in the order of the enumeration
constexpr std::array<FormatFacts, 7> kFormats = {{
    {MotionFormat::kCsv, ".csv", ".csv"},
    {MotionFormat::kCsvSoma, ".csv", ".soma.csv"},
    {MotionFormat::kNpzMjlab, ".npz", ".mjlab.npz"},
    {MotionFormat::kNpzBeyondMimic, ".npz", ".beyondmimic.npz"},
    {MotionFormat::kPklGmr, ".pkl", ".gmr.pkl"},
    {MotionFormat::kPklPbhc, ".pkl", ".pbhc.pkl"},
    {MotionFormat::kGlb, ".glb", ".glb"},
}};

const FormatFacts& facts(MotionFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

}  // namespace

std::string_view format_name(MotionFormat format) {
  return enum_name(format);
}

std::vector<std::string> format_names() {
  return enum_names<MotionFormat>();
}

Result<MotionFormat> format_from_name(std::string_view name) {
  if (const auto format = enum_from_name<MotionFormat>(name)) return *format;
  const auto names = format_names();
  return usage_failure(fmt::format("there is no format \"{}\"{}", name, did_you_mean(name, names)),
                       "the formats are " + list_names(names));
}

std::string_view format_ending(MotionFormat format) {
  return facts(format).ending;
}

std::string_view format_long_ending(MotionFormat format) {
  return facts(format).long_ending;
}

}  // namespace retarget
