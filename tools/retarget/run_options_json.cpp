#include "run_options_json.h"

#include <string_view>
#include <type_traits>
#include <utility>

#include "base/utf8.h"
#include "check_as_command_line.h"

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
  visit("lead-in", options.lead_in);
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

constexpr std::string_view kHexEnd = "_hex";

bool same_kind(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b) {
  return a.type() == b.type() || (a.is_number() && b.is_number());
}

}  // namespace

void put_name(nlohmann::ordered_json& json, const std::string& key, const std::string& bytes) {
  std::string text = valid_utf8(bytes);
  const bool as_it_is = text == bytes;
  json[key] = std::move(text);
  if (!as_it_is) json[key + std::string(kHexEnd)] = hex_text(bytes);
}

std::string name_from(const nlohmann::ordered_json& json, const std::string& key) {
  const auto text_of = [&](const std::string& name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const std::string hex = text_of(key + std::string(kHexEnd));
  if (auto bytes = bytes_from_hex(hex); bytes && !hex.empty()) return std::move(*bytes);
  return text_of(key);
}

nlohmann::ordered_json run_options_json(const RunOptions& options) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  each_option(options, [&](const char* name, const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::string>) {
      put_name(json, name, value);
    } else {
      json[name] = value;
    }
  });
  return json;
}

Result<RunOptions> run_options_from_json(const nlohmann::ordered_json& json,
                                         const std::string& file) {
  const auto known = run_options_json(RunOptions());
  if (!json.is_object()) return input_failure(file, "the sidecar has no options");
  for (const auto& [name, value] : json.items()) {
    const bool hex = name.ends_with(kHexEnd) && value.is_string() &&
                     known.contains(name.substr(0, name.size() - kHexEnd.size()));
    if (hex) continue;
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
  if (auto sound = check_as_command_line(json, known, file); !sound) {
    return failure(sound.error());
  }
  RunOptions options;
  // runs whose options were recorded before there was a choice took every frame
  options.lead_in = "keep";
  each_option(options, [&](const char* name, auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if (!json.contains(name)) return;
    if constexpr (std::is_same_v<Value, std::string>) {
      value = name_from(json, name);
    } else {
      value = json[name].template get<Value>();
    }
  });
  return options;
}

}  // namespace retarget::cli
