#include "run_options_json.h"

#include <type_traits>

namespace retarget::cli {
namespace {

// visits each option with its name; options are const or not as the caller's
template <typename Options, typename Visit>
void each_option(Options& options, const Visit& visit) {
  auto& source = options.source;
  auto& human = options.human;
  visit("motion", source.file);
  visit("smpl", source.smpl);
  visit("smpl-model", source.smpl_model);
  visit("lenient", source.lenient);
  visit("root", source.root);
  visit("source-fps", source.source_fps);
  visit("map", human.map);
  visit("partial", human.partial);
  visit("rest", human.rest);
  visit("tpose-frame", human.tpose_frame);
  visit("tpose-file", human.tpose_file);
  visit("unit", human.unit);
  visit("up", human.up);
  visit("forward", human.forward);
  visit("height", human.height);
  visit("start", options.start_s);
  visit("end", options.end_s);
  visit("frames", options.frames);
  visit("robot", options.robot);
  visit("robot-xml", options.robot_xml);
  visit("robot-profile", options.robot_profile);
  visit("dof", options.dof);
  visit("limits", options.limits);
  visit("ik-config", options.ik_config);
  visit("method", options.method);
  visit("fit-config", options.fit_config);
  visit("window", options.fit_window_s);
  visit("without", options.without);
  visit("engine", options.engine);
  visit("scale", options.scale);
  visit("fps", options.fps);
  visit("interpolation", options.interpolation);
  visit("no-antialias", options.no_antialias);
  visit("output", options.output);
  visit("format", options.formats);
  visit("precision", options.precision);
  visit("csv-delimiter", options.delimiter);
  visit("csv-header", options.header);
  visit("csv-quat", options.quaternion);
  visit("csv-frame-column", options.frame_column);
  visit("csv-degrees", options.degrees);
  visit("csv-centimetres", options.centimetres);
  visit("normalize-start", options.normalize_start);
  visit("npz-fps", options.npz_fps);
  visit("npz-velocity", options.npz_velocity);
  visit("motion-name", options.motion_name);
}

bool same_kind(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b) {
  return a.type() == b.type() || (a.is_number() && b.is_number());
}

}  // namespace

nlohmann::ordered_json run_options_json(const RunOptions& options) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  each_option(options, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

Result<RunOptions> run_options_from_json(const nlohmann::ordered_json& json,
                                         const std::string& file) {
  const auto known = run_options_json(RunOptions());
  if (!json.is_object()) return input_failure(file, "the sidecar has no options");
  for (const auto& [name, value] : json.items()) {
    if (!known.contains(name)) {
      return input_failure(file, "the sidecar has the unknown option \"" + name + "\"",
                           "it may come from a newer version of this tool");
    }
    bool sound = same_kind(known[name], value);
    if (sound && value.is_array()) {
      for (const auto& each : value) sound = sound && each.is_string();
    }
    if (!sound) {
      return input_failure(file, "the sidecar's option \"" + name + "\" is of another kind");
    }
  }
  RunOptions options;
  each_option(options, [&](const char* name, auto& value) {
    if (json.contains(name)) value = json[name].get<std::remove_cvref_t<decltype(value)>>();
  });
  return options;
}

}  // namespace retarget::cli
