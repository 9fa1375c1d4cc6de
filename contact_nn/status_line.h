// Progress of long work, for people who watch.
#pragma once

#include <cstdio>
#include <string>

#include <unistd.h>

namespace quayside::contact_nn {

// A line on the terminal that is drawn over and gone in the end; nothing when stderr is no terminal.
class StatusLine {
 public:
  StatusLine() = default;
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;
  ~StatusLine() {
    if (drawn_) std::fputs("\r\033[K", stderr);
  }
  void show(const std::string& text) {
    if (!terminal_) return;
    std::fprintf(stderr, "\r%s\033[K", text.c_str());
    std::fflush(stderr);
    drawn_ = true;
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  bool drawn_ = false;
};

}  // namespace quayside::contact_nn
