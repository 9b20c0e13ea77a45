#pragma once

#include "retarget/gallery.h"
#include "retarget/option_table.h"

namespace retarget::python {

/// Returns the options of a gallery except its folders and the robot.
[[nodiscard]] OptionTable gallery_keywords(GalleryRequest& request);

}  // namespace retarget::python
