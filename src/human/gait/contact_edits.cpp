#include "retarget/contact_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "human/gait/contact_parts.h"
#include "retarget/contact_plan.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Supports in the order of kSupportBones.
constexpr std::array<ContactPart, 14> kContactParts = {{{"left_foot", 0},
                                                        {"right_foot", 1},
                                                        {"left_heel", 0, kHeelEnd},
                                                        {"left_toe", 0, kToeEnd},
                                                        {"right_heel", 1, kHeelEnd},
                                                        {"right_toe", 1, kToeEnd},
                                                        {"left_knee", -1, -1, 0},
                                                        {"right_knee", -1, -1, 1},
                                                        {"left_elbow", -1, -1, 2},
                                                        {"right_elbow", -1, -1, 3},
                                                        {"left_hand", -1, -1, 4},
                                                        {"right_hand", -1, -1, 5},
                                                        {"seat", -1, -1, 6},
                                                        {"back", -1, -1, 7}}};
constexpr std::array<std::string_view, 3> kActions = {"add", "remove", "shift"};
// The surface under a foot: as far as a human steps.
constexpr double kMaxSurface = 3.0;

// Reads the edits of one file; faults carry the number of the edit.
class EditReader {
 public:
  explicit EditReader(Faults& faults) : faults_(faults) {}

  ContactEdit read(const nlohmann::ordered_json& json, std::size_t number) {
    const std::string where = fmt::format("edit {}: ", number);
    ContactEdit edit;
    if (!json.is_object()) {
      faults_.add(where + "expected an object");
      return edit;
    }
    const JsonMembers members(json, faults_, where);
    members.check_keys({"part", "action", "start", "end", "by", "height"});
    edit.part = members.text("part");
    const std::vector<std::string> parts = contact_part_names();
    if (find_contact_part(edit.part) == nullptr) {
      faults_.add(fmt::format("{}no part \"{}\"{}; known parts: {}", where, edit.part,
                              faults_.suggestion(edit.part, parts),
                              list_names(parts, parts.size())));
    }
    read_action(members.text("action"), where, edit);
    edit.start = number_of(members, "start", where).value_or(0.0);
    edit.end = number_of(members, "end", where).value_or(0.0);
    if (edit.start >= edit.end) faults_.add(where + "\"start\" must be before \"end\"");
    if (edit.action == ContactAction::kShift) {
      edit.by = number_of(members, "by", where).value_or(0.0);
    }
    if (members.find("height") != nullptr) {
      edit.height = number_of(members, "height", where).value_or(0.0);
      if (std::abs(edit.height) > kMaxSurface) {
        faults_.add(
            fmt::format("{}\"height\" must be from {} to {} m", where, -kMaxSurface, kMaxSurface));
      }
    }
    return edit;
  }

 private:
  void read_action(const std::string& name, const std::string& where, ContactEdit& edit) {
    const auto found = std::ranges::find(kActions, name);
    if (found == kActions.end()) {
      faults_.add(
          fmt::format("{}\"action\" must be add, remove or shift, found \"{}\"", where, name));
      return;
    }
    edit.action = static_cast<ContactAction>(found - kActions.begin());
  }

  std::optional<double> number_of(const JsonMembers& members, const std::string& key,
                                  const std::string& where) {
    const auto* value = members.find(key);
    if (value != nullptr && value->is_number() && std::isfinite(value->get<double>())) {
      return value->get<double>();
    }
    faults_.add(fmt::format("{}\"{}\" must be a number of {}", where, key,
                            key == "height" ? "metres" : "seconds"));
    return std::nullopt;
  }

  Faults& faults_;
};

}  // namespace

const ContactPart* find_contact_part(std::string_view name) {
  const auto* found = std::ranges::find(kContactParts, name, &ContactPart::name);
  return found == kContactParts.end() ? nullptr : found;
}

std::vector<std::string> contact_part_names() {
  std::vector<std::string> names;
  for (const ContactPart& part : kContactParts) names.emplace_back(part.name);
  return names;
}

Result<std::vector<ContactEdit>> parse_contact_edits(std::string_view text,
                                                     const std::string& file) {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  const auto list = json.is_object() ? json.find("contacts") : json.end();
  if (!json.is_object() || list == json.end() || !list->is_array()) {
    return config_failure(file, "expected an object with a list \"contacts\"",
                          R"({"contacts": [{"part": "left_foot", "start": 1.2, "end": 1.8, )"
                          R"("action": "add"}]})");
  }
  Faults faults;
  EditReader reader(faults);
  std::vector<ContactEdit> edits;
  for (const auto& each : *list) edits.push_back(reader.read(each, edits.size() + 1));
  if (!faults.empty()) return faults.failure_in(file, "the contact edits");
  return edits;
}

Result<std::vector<ContactEdit>> load_contact_edits(const std::string& file) {
  TRY_ASSIGN(const auto text, read_file(file, ErrorKind::kConfig, kMaxTextBytes));
  return parse_contact_edits(text.view(), file);
}

std::string contact_edits_text(std::span<const ContactEdit> edits) {
  auto list = nlohmann::ordered_json::array();
  for (const ContactEdit& edit : edits) {
    nlohmann::ordered_json json = {{"part", edit.part},
                                   {"action", kActions[static_cast<std::size_t>(edit.action)]},
                                   {"start", edit.start},
                                   {"end", edit.end}};
    if (edit.action == ContactAction::kShift) json["by"] = edit.by;
    if (edit.height != 0.0) json["height"] = edit.height;
    list.push_back(std::move(json));
  }
  return nlohmann::ordered_json{{"contacts", std::move(list)}}.dump(2) + "\n";
}

Result<void> check_contact_edits(std::span<const ContactEdit> edits, double seconds,
                                 const std::string& file) {
  constexpr double kRounding = 1e-6;
  Faults faults;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (edits[i].start < -kRounding || edits[i].end > seconds + kRounding) {
      faults.add(
          fmt::format("edit {}: {:.3f} to {:.3f} s is outside the motion, which lasts {:.3f} s",
                      i + 1, edits[i].start, edits[i].end, seconds));
    }
  }
  if (faults.empty()) return {};
  Failure failure = faults.failure_in(file, "the contact edits");
  failure.value().hint = "times count from the first frame of the motion, in seconds";
  return failure;
}

}  // namespace retarget
