#pragma once

namespace retarget {

// clang does not define GCC's __SANITIZE_* macros.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RETARGET_UNDER_SANITIZER 1
#endif
#endif

/// Whether the build uses the address or thread sanitizer of GCC or clang.
#if defined(RETARGET_UNDER_SANITIZER) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderSanitizer = true;
#else
inline constexpr bool kUnderSanitizer = false;
#endif

}  // namespace retarget
