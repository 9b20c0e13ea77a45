#pragma once

/// What the public headers declare is seen from outside of a shared library; the rest need not be.
/// Stands before a namespace's name: `namespace RETARGET_API retarget {`.
#if defined(__GNUC__)
#define RETARGET_API [[gnu::visibility("default")]]
#else
#define RETARGET_API
#endif
