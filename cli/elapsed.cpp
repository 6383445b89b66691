#include "elapsed.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>

namespace wavefog::cli {

Elapsed::Elapsed(std::string label) {
    if (isatty(STDERR_FILENO) != 1) return;
    clock_ = std::jthread([label = std::move(label)](const std::stop_token& stop) {
        std::mutex mutex;
        std::condition_variable_any stopped;
        std::unique_lock lock(mutex);
        for (int seconds = 1;; ++seconds) {
            const bool ends =
                stopped.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
            if (ends || stop.stop_requested()) break;
            fmt::print(stderr, "\r\033[K{}  {} s", label, seconds);
            std::fflush(stderr);
        }
        fmt::print(stderr, "\r\033[K");
        std::fflush(stderr);
    });
}

}  // namespace wavefog::cli
