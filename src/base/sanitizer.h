#pragma once

namespace retarget {

// clang has no such macros of its own
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RETARGET_UNDER_SANITIZER 1
#endif
#endif

/// Whether this is a build under the address or thread sanitizer, of GCC or clang.
#if defined(RETARGET_UNDER_SANITIZER) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderSanitizer = true;
#else
inline constexpr bool kUnderSanitizer = false;
#endif

}  // namespace retarget
