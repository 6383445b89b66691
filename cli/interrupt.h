// Ctrl-C while files are written must not leave half of one.
#pragma once

#include <csignal>

namespace wavefog::cli {

/// While one lives, SIGINT and SIGTERM wait, in all threads; afterwards the process ends by them.
/// Meant for the short time in which temporary files exist; elsewhere a signal acts at once.
class HoldInterrupts {
  public:
    HoldInterrupts();
    HoldInterrupts(const HoldInterrupts&) = delete;
    HoldInterrupts& operator=(const HoldInterrupts&) = delete;
    ~HoldInterrupts();

  private:
    struct sigaction interrupt_ = {}, terminate_ = {};
};

}  // namespace wavefog::cli
