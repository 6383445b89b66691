// Long work over many items: all cores and a progress line.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace wavefog::cli {

/// Keeps "label  42 %" on a terminal's last line; writes it every ten seconds where stderr goes
/// elsewhere, for the logs of render queues.
class Progress {
  public:
    Progress(std::string label, std::size_t count);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress();
    void update(std::size_t done);

  private:
    std::string label_;
    std::size_t count_;
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Calls body(begin, end) over [0, count) in chunks on all cores. Shows its Progress.
void parallel_chunks(const std::string& label, std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace wavefog::cli
