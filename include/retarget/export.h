#pragma once

/// Exports the declarations of the public headers from a shared library; the rest may stay hidden.
/// Goes before a namespace's name: `namespace RETARGET_API retarget {`.
#if defined(__GNUC__)
#define RETARGET_API [[gnu::visibility("default")]]
#else
#define RETARGET_API
#endif
