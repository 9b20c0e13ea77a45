#include "human_source.h"

#include <array>
#include <charconv>
#include <utility>

#include "base/file.h"
#include "base/suggest.h"
#include "base/text_size.h"
#include "bvh/read_bvh.h"
#include "human/bone_map_file.h"
#include "human/limb_directions.h"
#include "human/recognise.h"

namespace retarget::cli {
namespace {

// name and length in metres
constexpr std::array<std::pair<std::string_view, double>, 6> kUnits = {
    {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}, {"cmu", 0.056444}}};

Result<std::optional<double>> unit_from(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  for (const auto& [name, metres] : kUnits) {
    if (text == name) return std::optional<double>(metres);
  }
  double metres = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  if (error == std::errc() && end == text.data() + text.size() && metres >= 1e-6 && metres <= 1e6) {
    return std::optional<double>(metres);
  }
  return usage_failure(
      "--unit must be m, dm, cm, mm, inch, cmu, or metres from 0.000001 to "
      "1000000, found \"" +
      text + "\"");
}

Result<std::optional<SignedAxis>> axis_from(const std::string& option, std::string_view text) {
  if (text.empty()) return std::optional<SignedAxis>();
  const bool signed_text = text.front() == '-' || text.front() == '+';
  const std::string_view letter = signed_text ? text.substr(1) : text;
  if (letter == "x" || letter == "y" || letter == "z") {
    return std::optional<SignedAxis>(SignedAxis{letter.front() - 'x', text.front() == '-'});
  }
  return usage_failure(option + " must be x, y, z, -x, -y or -z, found \"" + std::string(text) +
                       "\"");
}

Result<RestPose> rest_from(const HumanOptions& options) {
  if (options.tpose_frame >= 0) {
    if (options.rest != "auto") {
      return usage_failure("--rest and --tpose-frame both choose a rest pose", "give one of them");
    }
    return RestPose::kFrame;
  }
  if (options.rest == "zero") return RestPose::kZero;
  if (options.rest == "first") return RestPose::kFirst;
  if (options.rest == "best") return RestPose::kBest;
  if (options.rest == "learned") return RestPose::kLearned;
  return RestPose::kAuto;
}

Result<CalibrationOptions> calibration_options(const HumanOptions& options,
                                               const SourceMotion& motion) {
  CalibrationOptions result;
  const auto unit = unit_from(options.unit);
  if (!unit) return failure(unit.error());
  result.metres_per_unit = *unit;
  result.unit_optional = options.unit_optional;
  const auto up = axis_from("--up", options.up);
  if (!up) return failure(up.error());
  result.up = *up;
  const auto forward = axis_from("--forward", options.forward);
  if (!forward) return failure(forward.error());
  result.forward = *forward;
  result.height = options.height > 0.0 ? std::optional<double>(options.height) : motion.height;
  const auto rest = rest_from(options);
  if (!rest) return failure(rest.error());
  result.rest = *rest;
  result.rest_frame = std::max(options.tpose_frame, 0);
  if (options.tpose_file.empty()) return result;
  if (result.rest != RestPose::kAuto) {
    return usage_failure("--tpose-file and another rest pose exclude each other",
                         "give one of them");
  }
  BvhReadOptions read_options;
  read_options.motion_optional = true;
  auto tpose = load_bvh(options.tpose_file, read_options);
  if (!tpose) return failure(tpose.error());
  result.tpose = std::move(tpose->clip);
  return result;
}

Result<BoneMap> find_bones(const SourceMotion& motion, const std::string& name,
                           const HumanOptions& options, const std::filesystem::path& dialects) {
  if (!options.map.empty()) return read_bone_map(options.map, motion.clip.skeleton());
  const auto known = load_dialects(dialects);
  if (!known) return failure(known.error());
  RecogniseOptions recognise_options;
  recognise_options.partial = options.partial;
  return recognise_skeleton(motion.clip, *known, name, recognise_options);
}

}  // namespace

Result<HumanSource> find_human(SourceMotion& motion, const SourceOptions& source,
                               const HumanOptions& options, const std::filesystem::path& dialects) {
  const std::string name = source_name(source);
  const auto how = calibration_options(options, motion);
  if (!how) return failure(how.error());
  auto map = find_bones(motion, name, options, dialects);
  if (!map) return failure(map.error());
  std::vector<Warning> doubts;
  if (auto doubt = let_directions_win(motion.clip, *map)) doubts.push_back(std::move(*doubt));
  auto calibration = calibrate(motion.clip, *map, *how, name);
  if (!calibration) return failure(calibration.error());
  auto& told = calibration->mapping.doubts;
  told.insert(told.begin(), doubts.begin(), doubts.end());
  if (!options.write_map.empty()) {
    auto written = write_file(options.write_map, format_bone_map(*map, motion.clip.skeleton()));
    if (!written) return failure(written.error());
  }
  return HumanSource{std::move(*map), std::move(*calibration)};
}

Result<void> check_human_options(const HumanOptions& options) {
  if (auto unit = unit_from(options.unit); !unit) return failure(unit.error());
  for (const auto& [name, text] :
       {std::pair("--up", &options.up), {"--forward", &options.forward}}) {
    if (auto axis = axis_from(name, *text); !axis) return failure(axis.error());
  }
  if (auto rest = rest_from(options); !rest) return failure(rest.error());
  for (const std::string* file : {&options.map, &options.tpose_file}) {
    if (file->empty()) continue;
    if (auto there = read_file(*file, ErrorKind::kConfig, kMostTextBytes); !there)
      return failure(there.error());
  }
  return {};
}

}  // namespace retarget::cli
