// A sign of life from work whose end nobody can foretell.
#pragma once

#include <string>
#include <thread>

namespace wavefog::cli {

/// Keeps "label  12 s" on a terminal's last line, from the second second on.
class Elapsed {
  public:
    explicit Elapsed(std::string label);
    Elapsed(const Elapsed&) = delete;
    Elapsed& operator=(const Elapsed&) = delete;

  private:
    std::jthread clock_;
};

}  // namespace wavefog::cli
