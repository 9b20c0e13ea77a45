#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <thread>

namespace retarget::python {

namespace nb = nanobind;

/// Waits until the process ends.
[[noreturn]] inline void wait_for_exit() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Whether this thread shuts the interpreter down: it released the GIL during the shutdown, so it
/// also held it then. Only this thread may take it again.
inline thread_local bool shuts_down = false;

/// Calls a function that takes the GIL. While the interpreter shuts down, a daemon thread waits here
/// until the process ends, as in Python 3.14. Earlier versions end the thread with an exception that
/// C++ functions cannot let pass, and the process would abort.
template <typename Function>
void take_gil(const Function& take) noexcept {
  try {
    if (Py_IsInitialized() != 0 || shuts_down) {
      take();
      return;
    }
  } catch (...) {
    wait_for_exit();  // Leaving this block would abort the process.
  }
  wait_for_exit();
}

/// Releases the GIL during its lifetime.
class ReleasedGil {
 public:
  ReleasedGil() noexcept {
    shuts_down = Py_IsInitialized() == 0;
    state_ = PyEval_SaveThread();
  }
  ~ReleasedGil() {
    take_gil([this] { PyEval_RestoreThread(state_); });
  }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_ = nullptr;
};

/// Holds the GIL during its lifetime, on any thread.
class HeldGil {
 public:
  HeldGil() noexcept {
    take_gil([this] { state_ = PyGILState_Ensure(); });
  }
  ~HeldGil() { PyGILState_Release(state_); }
  HeldGil(const HeldGil&) = delete;
  HeldGil& operator=(const HeldGil&) = delete;

 private:
  PyGILState_STATE state_ = PyGILState_UNLOCKED;
};

}  // namespace retarget::python
