// Included before each file of a release for Linux: libc++ checks indices, as _GLIBCXX_ASSERTIONS does with libstdc++
// (Hardening.cmake). The compiler's own driver would choose the mode without checks.
#undef _LIBCPP_HARDENING_MODE
#define _LIBCPP_HARDENING_MODE _LIBCPP_HARDENING_MODE_FAST
#undef _LIBCPP_ASSERTION_SEMANTIC_DEFAULT
#define _LIBCPP_ASSERTION_SEMANTIC_DEFAULT _LIBCPP_ASSERTION_SEMANTIC_HARDENING_DEPENDENT
