#pragma once

#include "edit_source.h"
#include "options/option_table.h"

namespace retarget::python {

/// The options that all edits have: how the human is recognised, which part is taken.
[[nodiscard]] OptionTable edit_table(EditOptions& options);

}  // namespace retarget::python
