// Ctrl-C, consoles and the command line of Windows.

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX 1
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <shellapi.h>

#include <atomic>
#include <string_view>

#include "console.h"

namespace retarget::cli {
namespace {

// Windows calls handlers on a separate thread.
std::atomic<bool> interrupt_seen = false, recalibration_asked = false, takes_breaks = false;
// Number of live guards; the first one installs the handler.
std::atomic<int> guards = 0;

// Returning FALSE ends the process: a second Ctrl-C, or one outside a guard.
BOOL WINAPI note_event(DWORD event) {
  if (event == CTRL_BREAK_EVENT && takes_breaks) {
    recalibration_asked = true;
    return TRUE;
  }
  if (guards == 0) return FALSE;
  return interrupt_seen.exchange(true) ? FALSE : TRUE;
}

HANDLE handle_of(int stream) {
  return ::GetStdHandle(stream == 0   ? STD_INPUT_HANDLE
                        : stream == 1 ? STD_OUTPUT_HANDLE
                                      : STD_ERROR_HANDLE);
}

std::string utf8(std::wstring_view text) {
  const int size = static_cast<int>(text.size());
  const int length =
      ::WideCharToMultiByte(CP_UTF8, 0, text.data(), size, nullptr, 0, nullptr, nullptr);
  std::string result(static_cast<std::size_t>(length), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, text.data(), size, result.data(), length, nullptr, nullptr);
  return result;
}

}  // namespace

struct InterruptGuard::Before {};

InterruptGuard::InterruptGuard() : outermost_(guards++ == 0) {
  if (!outermost_) return;
  interrupt_seen = false;
  ::SetConsoleCtrlHandler(note_event, TRUE);
}

InterruptGuard::~InterruptGuard() {
  --guards;
  if (outermost_) ::SetConsoleCtrlHandler(note_event, FALSE);
}

bool InterruptGuard::interrupted() {
  return interrupt_seen;
}

// There are no worker processes on Windows.
void leave_interrupts_to_parent() {}

void turn_write_signals_into_errors() {}

struct RecalibrationSignal::Before {};

RecalibrationSignal::RecalibrationSignal() {
  recalibration_asked = false;
  takes_breaks = true;
}

RecalibrationSignal::~RecalibrationSignal() {
  takes_breaks = false;
}

bool RecalibrationSignal::take() {
  return recalibration_asked.exchange(false);
}

std::vector<std::string> words_of_program(int argc, char** argv) {
  // The C library keeps the numbers of standard streams that are closed, so no file takes them.
  // Otherwise the C library writes a line feed as two bytes, and ends a file at Ctrl-Z.
  for (const int stream : {0, 1, 2}) ::_setmode(stream, _O_BINARY);
  ::SetConsoleOutputCP(CP_UTF8);
  // main receives the words in the system's code page, and the C library has expanded their
  // patterns.
  int count = 0;
  wchar_t** const wide = ::CommandLineToArgvW(::GetCommandLineW(), &count);
  if (wide == nullptr) return {argv, argv + argc};
  std::vector<std::string> words;
  for (int i = 0; i < count; ++i) words.push_back(utf8(wide[i]));
  ::LocalFree(static_cast<HLOCAL>(wide));
  return words;
}

bool is_terminal(int stream) {
  DWORD mode = 0;
  return ::GetConsoleMode(handle_of(stream), &mode) != 0;
}

bool terminal_takes_colours(int stream) {
  DWORD mode = 0;
  return ::GetConsoleMode(handle_of(stream), &mode) != 0 &&
         ::SetConsoleMode(handle_of(stream),
                          mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

}  // namespace retarget::cli
