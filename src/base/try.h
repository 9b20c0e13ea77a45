#pragma once

#include "retarget/try.h"

// Short names inside the core.
#define TRY(...) RETARGET_TRY(__VA_ARGS__)
#define TRY_ASSIGN(target, ...) RETARGET_TRY_ASSIGN(target, __VA_ARGS__)
