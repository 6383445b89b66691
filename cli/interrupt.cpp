#include "interrupt.h"

namespace wavefog::cli {
namespace {

volatile std::sig_atomic_t held_signal = 0;

extern "C" void hold_signal(int signal) {
    held_signal = signal;
}

}  // namespace

HoldInterrupts::HoldInterrupts() {
    struct sigaction hold = {};
    hold.sa_handler = hold_signal;
    hold.sa_flags = SA_RESTART;
    sigemptyset(&hold.sa_mask);
    sigaction(SIGINT, &hold, &interrupt_);
    sigaction(SIGTERM, &hold, &terminate_);
}

HoldInterrupts::~HoldInterrupts() {
    sigaction(SIGINT, &interrupt_, nullptr);
    sigaction(SIGTERM, &terminate_, nullptr);
    if (held_signal != 0) std::raise(held_signal);
}

}  // namespace wavefog::cli
