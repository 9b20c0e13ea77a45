#include "io/motion_format.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/suggest.h"
#include "options/enum_names.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// in the order of the enumeration
constexpr std::array<FormatFacts, 12> kFormats = {{
    {MotionFormat::kCsv, ".csv", ".csv", false, write_csv},
    {MotionFormat::kCsvSoma, ".csv", ".soma.csv", false, write_csv},
    {MotionFormat::kNpzMjlab, ".npz", ".mjlab.npz", true, write_tracking_npz},
    {MotionFormat::kNpzBeyondMimic, ".npz", ".beyondmimic.npz", true, write_tracking_npz},
    {MotionFormat::kPklGmr, ".pkl", ".gmr.pkl", false, write_gmr_pickle},
    {MotionFormat::kPklPbhc, ".pkl", ".pbhc.pkl", false, write_motion_lib_pickle},
    {MotionFormat::kGlb, ".glb", ".glb", false, write_glb},
    {MotionFormat::kNpzHolosoma, ".npz", ".holosoma.npz", true, write_tracking_npz},
    {MotionFormat::kPklMotionLib, ".pkl", ".motion-lib.pkl", false, write_motion_lib_pickle},
    {MotionFormat::kPklMimicKit, ".pkl", ".mimickit.pkl", false, write_mimickit_pickle},
    {MotionFormat::kProtoMotions, ".motion", ".motion", false, write_protomotions},
    {MotionFormat::kCsvSonic, "", ".sonic", true, write_sonic_folder},
}};

}  // namespace

const FormatFacts& format_facts(MotionFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

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
  return format_facts(format).ending;
}

bool format_is_folder(MotionFormat format) {
  return format_facts(format).ending.empty();
}

std::vector<std::string> folder_file_names(MotionFormat format) {
  if (!format_is_folder(format)) return {};
  return {"joint_pos.csv",    "joint_vel.csv",    "body_pos.csv", "body_quat.csv",
          "body_lin_vel.csv", "body_ang_vel.csv", "metadata.txt", "contacts.csv"};
}

bool format_has_own_rate(MotionFormat format) {
  return format_facts(format).has_own_rate;
}

std::string_view format_long_ending(MotionFormat format) {
  return format_facts(format).long_ending;
}

}  // namespace retarget
