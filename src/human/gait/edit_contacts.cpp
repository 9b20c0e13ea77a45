#include "human/gait/edit_contacts.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
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

// Returns null for an unknown name.
const ContactPart* find_contact_part(std::string_view name) {
  const auto* found = std::ranges::find(kContactParts, name, &ContactPart::name);
  return found == kContactParts.end() ? nullptr : found;
}

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
    } else if (members.find("by") != nullptr) {
      faults_.add(where + "\"by\" applies only to the action shift");
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

namespace {

bool leaves_motion(const ContactEdit& edit, double seconds) {
  return edit.action == ContactAction::kShift &&
         (edit.end + edit.by <= 0.0 || edit.start + edit.by >= seconds);
}

}  // namespace

Result<void> check_contact_edits(std::span<const ContactEdit> edits, double seconds,
                                 const std::string& file) {
  constexpr double kRounding = 1e-6;
  Faults faults;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (edits[i].start < -kRounding || edits[i].end > seconds + kRounding) {
      faults.add(
          fmt::format("edit {}: {:.3f} to {:.3f} s is outside the motion, which lasts {:.3f} s",
                      i + 1, edits[i].start, edits[i].end, seconds));
    } else if (leaves_motion(edits[i], seconds)) {
      faults.add(fmt::format(
          "edit {}: shifted by {:.3f} s, {:.3f} to {:.3f} s is outside the motion, which lasts "
          "{:.3f} s",
          i + 1, edits[i].by, edits[i].start + edits[i].by, edits[i].end + edits[i].by, seconds));
    }
  }
  if (faults.empty()) return {};
  Failure failure = faults.failure_in(file, "the contact edits");
  failure.value().hint = "times count from the first frame of the motion, in seconds";
  return failure;
}

namespace {

using Phases = std::vector<ContactPhase>;

// Removes [begin, end) from phases, which are sorted and do not overlap.
void cut_phases(Phases& phases, int begin, int end) {
  Phases kept;
  for (const ContactPhase& phase : phases) {
    if (phase.begin < begin)
      kept.push_back({phase.begin, std::min(phase.end, begin), phase.support});
    if (phase.end > end) kept.push_back({std::max(phase.begin, end), phase.end, phase.support});
  }
  phases = std::move(kept);
}

// Adds [begin, end), joined with touching phases on the same surface. Existing phases do not
// change.
void fill_phases(Phases& phases, int begin, int end, double support) {
  Phases gaps = {{begin, end, support}};
  for (const ContactPhase& phase : phases) cut_phases(gaps, phase.begin, phase.end);
  phases.insert(phases.end(), gaps.begin(), gaps.end());
  std::ranges::sort(phases, {}, &ContactPhase::begin);
  Phases joined;
  for (const ContactPhase& phase : phases) {
    const bool touches_edit = phase.begin <= end && phase.end >= begin;
    if (touches_edit && !joined.empty() && joined.back().end == phase.begin &&
        joined.back().support == phase.support) {
      joined.back().end = phase.end;
    } else {
      joined.push_back(phase);
    }
  }
  phases = std::move(joined);
}

// The surface of a phase that touches [begin, end), so that an extended stance keeps its height.
std::optional<double> support_near(const Phases& phases, int begin, int end) {
  for (const ContactPhase& phase : phases) {
    if (phase.begin <= end && phase.end >= begin) return phase.support;
  }
  return std::nullopt;
}

// The frames in which two lists are in contact with one surface.
Phases common_phases(const Phases& a, const Phases& b) {
  Phases common;
  for (const ContactPhase& first : a) {
    for (const ContactPhase& second : b) {
      const int begin = std::max(first.begin, second.begin), end = std::min(first.end, second.end);
      if (begin < end && first.support == second.support) {
        common.push_back({begin, end, first.support});
      }
    }
  }
  return common;
}

class ContactEditor {
 public:
  ContactEditor(const SourceFeet& source, ContactPlan& contacts)
      : source_(source), contacts_(contacts), frames_(source.frame_count()) {}

  // @return whether the edit changed anything.
  bool apply(const ContactEdit& edit) {
    const ContactPart* part = find_contact_part(edit.part);
    if (part == nullptr) return false;
    const int begin = frame_at(edit.start), end = frame_at(edit.end);
    if (begin >= end) return false;
    changed_begin_ = frames_;
    changed_end_ = 0;
    if (part->foot < 0) return change(contacts_.bodies[part->support], edit, begin, end);
    const int foot = part->foot;
    bool changed = false;
    for (const int end_of_foot : {kHeelEnd, kToeEnd}) {
      if (part->end >= 0 && part->end != end_of_foot) continue;
      if (!source_.has(foot, end_of_foot)) continue;
      const Phases before = contacts_.ends[foot][end_of_foot].phases;
      if (change(contacts_.ends[foot][end_of_foot].phases, edit, begin, end)) {
        changed = true;
        set_levels(foot, end_of_foot, before);
      }
    }
    if (changed) update_foot(foot);
    return changed;
  }

 private:
  [[nodiscard]] int frame_at(double seconds) const {
    return std::clamp(static_cast<int>(std::lround(seconds / source_.frame_time)), 0, frames_);
  }

  bool change(Phases& phases, const ContactEdit& edit, int begin, int end) {
    const Phases before = phases;
    if (edit.action == ContactAction::kRemove) {
      cut_phases(phases, begin, end);
      note(begin, end);
    } else if (edit.action == ContactAction::kAdd) {
      const double support =
          edit.height != 0.0 ? edit.height : support_near(phases, begin, end).value_or(0.0);
      fill_phases(phases, begin, end, support);
      note(begin, end);
    } else {
      shift(phases, begin, end, static_cast<int>(std::lround(edit.by / source_.frame_time)));
    }
    return !std::ranges::equal(before, phases, [](const ContactPhase& a, const ContactPhase& b) {
      return a.begin == b.begin && a.end == b.end && a.support == b.support;
    });
  }

  void shift(Phases& phases, int begin, int end, int by) {
    Phases moved;
    for (const ContactPhase& phase : phases) {
      // A contact that would leave the motion stays.
      const bool is_inside = phase.begin + by < frames_ && phase.end + by > 0;
      if (phase.begin < end && phase.end > begin && is_inside) moved.push_back(phase);
    }
    for (const ContactPhase& phase : moved) {
      cut_phases(phases, phase.begin, phase.end);
      note(phase.begin, phase.end);
    }
    for (const ContactPhase& phase : moved) {
      const int first = std::clamp(phase.begin + by, 0, frames_);
      const int last = std::clamp(phase.end + by, 0, frames_);
      fill_phases(phases, first, last, phase.support);
      note(first, last);
    }
  }

  void note(int begin, int end) {
    changed_begin_ = std::min(changed_begin_, begin);
    changed_end_ = std::max(changed_end_, end);
  }

  // Frames that are newly in contact are level, those no longer in contact are not.
  void set_levels(int foot, int end_of_foot, const Phases& before) {
    EndContacts& contacts = contacts_.ends[foot][end_of_foot];
    contacts.level.resize(static_cast<std::size_t>(frames_), 0);
    Phases added = contacts.phases, removed = before;
    for (const ContactPhase& phase : before) cut_phases(added, phase.begin, phase.end);
    for (const ContactPhase& phase : contacts.phases) cut_phases(removed, phase.begin, phase.end);
    const auto set = [&](const Phases& phases, char value) {
      for (const ContactPhase& phase : phases) {
        std::fill(contacts.level.begin() + phase.begin, contacts.level.begin() + phase.end, value);
      }
    };
    set(added, 1);
    set(removed, 0);
  }

  void update_foot(int foot) {
    const int begin = changed_begin_, end = changed_end_;
    const bool has_toe = source_.has(foot, kToeEnd);
    const Phases& heel = contacts_.ends[foot][kHeelEnd].phases;
    Phases whole = has_toe ? common_phases(heel, contacts_.ends[foot][kToeEnd].phases) : heel;
    cut_phases(whole, 0, begin);
    cut_phases(whole, end, frames_);
    for (Phases* phases : {&contacts_.phases[foot], &contacts_.soles[foot]}) {
      cut_phases(*phases, begin, end);
      for (const ContactPhase& phase : whole) {
        fill_phases(*phases, phase.begin, phase.end, phase.support);
      }
    }
  }

  const SourceFeet& source_;
  ContactPlan& contacts_;
  const int frames_;
  // The range in which the whole-foot contacts of the edited foot are made again.
  int changed_begin_ = frames_, changed_end_ = 0;
};

}  // namespace

std::vector<std::size_t> edit_contacts(std::span<const ContactEdit> edits, const SourceFeet& source,
                                       ContactPlan& contacts) {
  std::vector<std::size_t> idle;
  ContactEditor editor(source, contacts);
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (!editor.apply(edits[i])) idle.push_back(i);
  }
  return idle;
}

}  // namespace retarget
