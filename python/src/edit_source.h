#pragma once

#include <string>

#include "handles.h"
#include "options/option_table.h"
#include "retarget/edit.h"
#include "retarget/plan.h"

namespace retarget::python {

/// A clip that is edited, and the human in it.
struct EditSource {
  Clip clip;
  HumanInClip human;

  [[nodiscard]] const Calibration& calibration() const { return human.calibration; }
  [[nodiscard]] Subject subject() const { return {clip, human.map, calibration()}; }
};

/// What an edit needs to know of its clip.
struct EditNeeds {
  bool unit = false;        ///< Something is told in metres.
  bool no_lead_in = false;  ///< The motion is looked at as a whole.
};

/// How the human is recognised and which part is taken.
struct EditOptions {
  HumanOptions human;
  PartOptions part;
};

/// As the command does: the human is recognised in the whole clip, then it is cut.
[[nodiscard]] Result<EditSource> edit_source(const Clip& clip, const EditOptions& options,
                                             const std::string& data_dir, EditNeeds needs);

}  // namespace retarget::python
