#include "retarget/batch/worker_pool.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "retarget/base/file.h"

namespace retarget {
namespace {

// a number that is all of a file's first line
std::optional<std::uint64_t> number_in(const std::string& path) {
  const auto file = read_file(path, ErrorKind::kRun);
  if (!file) return std::nullopt;
  const std::string_view text = file->view();
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

// the limits of the control groups that a process is in, of both versions
std::vector<std::string> limit_files() {
  std::vector<std::string> files;
  const auto groups = read_file("/proc/self/cgroup", ErrorKind::kRun);
  std::string_view text = groups ? groups->view() : std::string_view();
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string line(text.substr(0, length));
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool unified = controllers.empty();
    if (!unified && ("," + controllers + ",").find(",memory,") == std::string::npos) continue;
    const std::string root = unified ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    const char* const name = unified ? "/memory.max" : "/memory.limit_in_bytes";
    // a limit of a group above holds as well
    for (std::string group = line.substr(second + 1);; group.erase(group.rfind('/'))) {
      files.push_back(root + (group == "/" ? "" : group) + name);
      if (group.find('/') == std::string::npos) break;
    }
  }
  return files;
}

}  // namespace

int usable_cores() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::uint64_t usable_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return 0;
  std::uint64_t least = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
  for (const std::string& file : limit_files()) {
    if (const auto limit = number_in(file)) least = std::min(least, *limit);
  }
  return least;
}

}  // namespace retarget
