#include "parallel.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>
#include <vector>

namespace wavefog::cli {

Progress::Progress(std::string label, std::size_t count)
    : label_(std::move(label)), count_(count), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::update(std::size_t done) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(terminal_ ? 100 : 10000)) return;
    last_ = now;
    shown_ = terminal_;
    const std::string text = fmt::format("{}  {} %", label_, 100 * done / count_);
    fmt::print(stderr, "{}", terminal_ ? "\r" + text : text + "\n");
    std::fflush(stderr);
}

void parallel_chunks(const std::string& label, std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    Progress progress(label, count);
    std::atomic<std::size_t> next = 0;
    const auto work = [&](bool shows_progress) {
        for (;;) {
            const std::size_t begin = next.fetch_add(chunk);
            if (begin >= count) return;
            if (shows_progress) progress.update(begin);
            body(begin, std::min(begin + chunk, count));
        }
    };
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i)
        helpers.emplace_back(work, false);
    work(true);
    helpers.clear();
}

}  // namespace wavefog::cli
