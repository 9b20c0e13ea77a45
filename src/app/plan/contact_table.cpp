#include "retarget/contact_table.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "base/json.h"

namespace retarget {

std::string contacts_text(const ContactLabels& labels, const FrameRate& rate) {
  using Row = std::array<std::string, 8>;
  std::vector<Row> rows = {{"part", "robot", "surface", "first", "last", "start s", "end s", ""}};
  for (const SurfaceTouch& touch : labels.touches) {
    const int last = touch.end - 1;
    rows.push_back({touch.part, touch.link, touch.surface, std::to_string(touch.begin),
                    std::to_string(last), fmt::format("{:.2f}", rate.time_of(touch.begin)),
                    fmt::format("{:.2f}", rate.time_of(last)), touch.slides ? "slides" : ""});
  }
  std::array<std::size_t, 8> widths{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      // Align numbers to the right.
      const bool is_number = i >= 3 && i < 7;
      line += is_number ? fmt::format("{:>{}}  ", row[i], widths[i])
                        : fmt::format("{:<{}}  ", row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string contacts_json(const ContactLabels& labels, const FrameRate& rate) {
  nlohmann::ordered_json json = {{"frames", labels.frame_count}, {"fps", rate.fps()}};
  json["contacts"] = nlohmann::ordered_json::array();
  for (const SurfaceTouch& touch : labels.touches) {
    json["contacts"].push_back({{"part", touch.part},
                                {"link", touch.link},
                                {"surface", touch.surface},
                                {"first", touch.begin},
                                {"last", touch.end - 1},
                                {"start", rate.time_of(touch.begin)},
                                {"end", rate.time_of(touch.end - 1)},
                                {"slides", touch.slides}});
  }
  return json.dump(2) + "\n";
}

}  // namespace retarget
