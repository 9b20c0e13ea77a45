#include "human/gait/edit_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "human/gait/contact_parts.h"

namespace retarget {
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

// Adds [begin, end), joined with phases on the same surface that it touches. Existing phases stay.
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
      if (phase.begin < end && phase.end > begin) moved.push_back(phase);
    }
    for (const ContactPhase& phase : moved) {
      cut_phases(phases, phase.begin, phase.end);
      note(phase.begin, phase.end);
    }
    for (const ContactPhase& phase : moved) {
      const int first = std::clamp(phase.begin + by, 0, frames_);
      const int last = std::clamp(phase.end + by, 0, frames_);
      if (first >= last) continue;
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
