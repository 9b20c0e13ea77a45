#include "check_as_command_line.h"

#include <algorithm>
#include <vector>

#include "declare.h"

namespace retarget::cli {
namespace {

using Json = nlohmann::ordered_json;

// `--name=value`; several of a list
std::vector<std::string> words_of(const std::string& name, const Json& value) {
  const std::string option = "--" + (name == "motion" ? "bvh" : name);
  if (value.is_boolean()) return {option + (value.get<bool>() ? "=true" : "=false")};
  if (value.is_string()) return {option + "=" + value.get<std::string>()};
  if (!value.is_array()) return {option + "=" + value.dump()};
  std::vector<std::string> words;
  for (const Json& each : value) words.push_back(option + "=" + each.get<std::string>());
  return words;
}

}  // namespace

Result<void> check_as_command_line(const Json& options, const Json& defaults,
                                   const std::string& file) {
  std::vector<std::string> words;
  for (const auto& [name, value] : options.items()) {
    // which reader the motion's file has is --bvh or --smpl, and no option of its own
    if (name == "smpl" || !defaults.contains(name) || value == defaults[name]) continue;
    for (std::string& word : words_of(name, value)) words.push_back(std::move(word));
  }
  CLI::App app;
  RunOptions parsed;
  add_run_options(app, parsed);
  // from the last to the first, as it takes them off
  std::ranges::reverse(words);
  try {
    app.parse(std::move(words));
  } catch (const CLI::Error& error) {
    return input_failure(
        file, "the sidecar's options are none that a run takes: " + std::string(error.what()));
  }
  return {};
}

}  // namespace retarget::cli
