// Repeatable randomness: every random test prints its seed, and WAVEFOG_TEST_SEED overrides it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace wavefog::test {

class Random {
  public:
    explicit Random(std::uint64_t default_seed) {
        const char* text = std::getenv("WAVEFOG_TEST_SEED");
        seed_ = text ? std::strtoull(text, nullptr, 10) : default_seed;
        std::printf("seed %llu (set WAVEFOG_TEST_SEED to change)\n",
                    static_cast<unsigned long long>(seed_));
        engine_.seed(seed_);
    }
    std::uint64_t seed() const { return seed_; }
    double uniform(double low = 0, double high = 1) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    int integer(int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(engine_);
    }
    double normal() { return std::normal_distribution<double>()(engine_); }

  private:
    std::uint64_t seed_ = 0;
    std::mt19937_64 engine_;
};

}  // namespace wavefog::test
