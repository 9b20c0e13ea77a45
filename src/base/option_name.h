#pragma once

#include "retarget/option_name.h"

// The short name inside the core.
#define OPTION(name) RETARGET_OPTION(name)
