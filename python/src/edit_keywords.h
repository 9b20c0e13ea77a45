#pragma once

#include "edit_source.h"
#include "retarget/option_table.h"

namespace retarget::python {

/// Returns the options common to all edits: how to recognise the human, and which part to use.
[[nodiscard]] OptionTable edit_table(EditOptions& options);

}  // namespace retarget::python
