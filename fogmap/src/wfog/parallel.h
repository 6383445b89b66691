// Independent pieces of work on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "scratch.h"

namespace wavefog::wfog {

/// Calls body(i, scratch) for all i < count on `threads` threads (0: as many as the machine has),
/// each i once, in any order; each thread has one Scratch. False if `stop` was requested before all
/// were done. What `body` throws first is thrown here, after all threads have ended.
template <class Body>
bool for_each_parallel(std::size_t count, int threads, const std::stop_token& stop, Body body) {
    std::atomic<std::size_t> next = 0;
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        try {
            Scratch scratch;
            for (std::size_t i; !stop.stop_requested() && (i = next.fetch_add(1)) < count;)
                body(i, scratch);
        } catch (...) {
            next = count;
            const std::lock_guard lock(failure_mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    const std::size_t wanted =
        threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency();
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < wanted && i < count; ++i) helpers.emplace_back(work);
    work();
    helpers.clear();
    if (failure) std::rethrow_exception(failure);
    return !stop.stop_requested();
}

}  // namespace wavefog::wfog
