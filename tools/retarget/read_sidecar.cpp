#include "read_sidecar.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "base/json_bounds.h"
#include "base/plain_name.h"
#include "run_options_json.h"

namespace retarget::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

Result<Sidecar> read_sidecar(std::string_view text, const std::string& file) {
  if (auto bounds = check_json_bounds(text, file); !bounds) {
    bounds.error().kind = ErrorKind::kInput;
    return failure(bounds.error());
  }
  const Json json = Json::parse(text, nullptr, false);
  const bool sound = json.is_object() && json.contains("output") && json["output"].is_object() &&
                     json.contains("options") && json.contains("inputs") &&
                     json["inputs"].is_array();
  if (!sound) {
    return input_failure(file, "the file is no sidecar of a run",
                         "retarget ... -o walk.csv --sidecar writes walk.csv.json");
  }
  Sidecar sidecar;
  sidecar.version = text_of(json, "retarget");
  sidecar.output = name_from(json["output"], "file");
  // it lies beside the sidecar
  if (!is_plain_name(sidecar.output)) {
    return input_failure(file, "the sidecar's output \"" + sidecar.output +
                                   "\" is not the name of a file beside it");
  }
  sidecar.format = text_of(json["output"], "format");
  sidecar.hash = text_of(json["output"], "hash");
  auto options = run_options_from_json(json["options"], file);
  if (!options) return failure(options.error());
  sidecar.options = std::move(*options);
  for (const Json& each : json["inputs"]) {
    if (!each.is_object()) continue;
    sidecar.files.push_back(
        {text_of(each, "role"), name_from(each, "file"), {}, text_of(each, "hash")});
  }
  return sidecar;
}

}  // namespace retarget::cli
