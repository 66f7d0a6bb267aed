// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/raw_terminal.h"

#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "rt/base/errors.h"

namespace sandrunner::ctl {
namespace {

termios before;

constexpr int kCrashes[] = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGQUIT};

// Pasted text comes between marks (KeyReader). A terminal that does not know this ignores it.
constexpr char kMarkPastes[] = "\x1b[?2004h", kDoNot[] = "\x1b[?2004l";

template <std::size_t kSize>
void send(const char (&text)[kSize]) {
  if (isatty(STDOUT_FILENO) == 0) return;
  if (write(STDOUT_FILENO, text, kSize - 1) < 0) return;  // nobody looks
}

// Restores the terminal; the signal then has its default effect (SA_RESETHAND).
void crash(int number) {
  send(kDoNot);
  tcsetattr(STDIN_FILENO, TCSANOW, &before);
  raise(number);
}

}  // namespace

RawTerminal::RawTerminal() {
  if (tcgetattr(STDIN_FILENO, &before) != 0) {
    throw InputError("drive: found a standard input that is not a terminal, expected a keyboard");
  }
  struct sigaction action{};
  action.sa_handler = crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int number : kCrashes) sigaction(number, &action, nullptr);
  termios raw = before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN);
  raw.c_iflag &= ~static_cast<tcflag_t>(IXON);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  send(kMarkPastes);
}

RawTerminal::~RawTerminal() {
  send(kDoNot);
  // Keys that were typed but not read must not reach the shell.
  tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
  for (const int number : kCrashes) signal(number, SIG_DFL);
}

std::string RawTerminal::read() {
  char bytes[64];
  ssize_t size;
  do {
    size = ::read(STDIN_FILENO, bytes, sizeof bytes);
  } while (size < 0 && errno == EINTR);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

}  // namespace sandrunner::ctl
