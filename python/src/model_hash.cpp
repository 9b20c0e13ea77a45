// The hash of a robot's model, by which a pickle recognises it.

#include <filesystem>
#include <set>
#include <string>

#include "handles.h"
#include "retarget/file.h"
#include "retarget/hash.h"

namespace retarget::python {
namespace {

namespace fs = std::filesystem;

// Adds a file and the files that it includes, each once.
bool hash_model_file(const fs::path& file, ContentHasher& hasher, std::set<std::string>& done) {
  if (file.empty() || !done.insert(file.lexically_normal().string()).second) return true;
  const auto content = read_file(file.string());
  if (!content) return false;
  const std::string_view text = content->view();
  hasher.update(text);
  constexpr std::string_view kInclude = "<include";
  for (std::size_t at = text.find(kInclude); at != std::string_view::npos;
       at = text.find(kInclude, at + 1)) {
    const std::string_view tag = text.substr(at, text.find('>', at) - at);
    const std::size_t begin = tag.find_first_of("\"'");
    if (begin == std::string_view::npos) continue;
    const std::size_t end = tag.find(tag[begin], begin + 1);
    if (end == std::string_view::npos) continue;
    const fs::path included = file.parent_path() / tag.substr(begin + 1, end - begin - 1);
    // MuJoCo reports an include that is missing; a comment may name one.
    if (is_file(included) && !hash_model_file(included, hasher, done)) return false;
  }
  return true;
}

}  // namespace

std::string model_hash(const LoadedRobot& robot) {
  auto hasher = ContentHasher::create();
  if (!hasher) return {};
  std::set<std::string> done;
  if (!hash_model_file(robot.model, *hasher, done)) return {};
  if (!hash_model_file(robot.profile, *hasher, done)) return {};
  const Robot& whole = robot.robot->whole() ? *robot.robot->whole() : *robot.robot;
  for (const RobotVariant& variant : whole.profile().variants) {
    if (!hash_model_file(variant.model, *hasher, done)) return {};
  }
  return hasher->finish().value_or(std::string());
}

}  // namespace retarget::python
