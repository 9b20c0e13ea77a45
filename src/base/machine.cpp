#include "retarget/machine.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/os.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Parses the first word of a file, or a later one, as a number. Returns nothing for `max` and -1,
// which mean no limit.
std::optional<std::uint64_t> number_in(const std::string& path, int words_before = 0) {
  const auto file = read_file(path, ErrorKind::kRun);
  if (!file) return std::nullopt;
  std::string_view text = file->view();
  for (; words_before > 0; --words_before) take_until(text, ' ');
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

// Folders of the control groups (v1 and v2) of a process for one controller, innermost group first.
struct ControlGroup {
  std::string folder;
  bool unified = false;  // cgroup v2.
};
std::vector<ControlGroup> control_groups(const std::string& root_of_all,
                                         const std::string& membership,
                                         std::string_view controller) {
  std::vector<ControlGroup> found;
  const auto groups = read_file(membership, ErrorKind::kRun);
  std::string_view text = groups ? groups->view() : std::string_view();
  while (!text.empty()) {
    const std::string line(take_until(text, '\n'));
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool unified = controllers.empty();
    const std::string wanted = "," + std::string(controller) + ",";
    if (!unified && ("," + controllers + ",").find(wanted) == std::string::npos) continue;
    const std::string root = root_of_all + (unified ? "" : "/" + std::string(controller));
    // Limits of parent groups apply as well.
    for (std::string group = line.substr(second + 1);; group.erase(group.rfind('/'))) {
      found.push_back({root + (group == "/" ? "" : group), unified});
      if (group.find('/') == std::string::npos) break;
    }
  }
  return found;
}

// CPU quota of a group in processors (quota over period). Returns nothing when it is unlimited.
std::optional<double> processors_of(const ControlGroup& group) {
  const std::string two_numbers = group.folder + "/cpu.max";
  const auto quota =
      group.unified ? number_in(two_numbers) : number_in(group.folder + "/cpu.cfs_quota_us");
  const auto period =
      group.unified ? number_in(two_numbers, 1) : number_in(group.folder + "/cpu.cfs_period_us");
  if (!quota || !period || *quota == 0 || *period == 0) return std::nullopt;
  return static_cast<double>(*quota) / static_cast<double>(*period);
}

}  // namespace

int usable_cores(const ControlGroupFiles& files) {
  // More threads than available CPU time would only wait for each other.
  double min = std::max(1U, std::thread::hardware_concurrency());
  for (const ControlGroup& group : control_groups(files.root, files.membership, "cpu")) {
    if (const auto processors = processors_of(group)) min = std::min(min, *processors);
  }
  return std::max(1, static_cast<int>(std::ceil(min)));
}

std::uint64_t usable_memory(const ControlGroupFiles& files) {
  std::uint64_t min = os::physical_memory();
  if (min == 0) return 0;
  for (const ControlGroup& group : control_groups(files.root, files.membership, "memory")) {
    const auto limit =
        number_in(group.folder + (group.unified ? "/memory.max" : "/memory.limit_in_bytes"));
    if (limit) min = std::min(min, *limit);
  }
  return min;
}

}  // namespace retarget
