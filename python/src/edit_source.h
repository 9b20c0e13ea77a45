#pragma once

#include <string>

#include "handles.h"
#include "retarget/edit.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"

namespace retarget::python {

/// A clip to edit and the human in it.
struct EditSource {
  Clip clip;
  HumanInClip human;

  [[nodiscard]] const Calibration& calibration() const { return human.calibration; }
  [[nodiscard]] Subject subject() const { return {clip, human.map, calibration()}; }
};

/// Requirements of an edit on its clip.
struct EditNeeds {
  bool unit = false;        ///< The edit has arguments in metres.
  bool no_lead_in = false;  ///< The edit analyses the whole motion, so a lead-in must be cut.
};

/// How to recognise the human, and which part to use.
struct EditOptions {
  HumanOptions human;
  PartOptions part;
};

/// Prepares a clip as the command does: recognises the human in the whole clip, then cuts it.
[[nodiscard]] Result<EditSource> edit_source(const Clip& clip, const EditOptions& options,
                                             const std::string& data_dir, EditNeeds needs);

}  // namespace retarget::python
