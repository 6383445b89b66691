// Forward plus inverse transform of a 2048 x 2048 float map on one core, beside memcpy of the same
// bytes. Rules: every case runs in this one program; memcpy is timed again in the middle of each
// case, so that another load on the machine hits both; counter "memcpys" = time of the case / time
// of memcpy; memory is allocated by the library inside the timed region, as it is for a caller.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "plain_transform.h"
#include "wavefog/wavelet/decomposition.h"

namespace {

using namespace wavefog;

constexpr int kSize = 2048;
constexpr int kLevels = 5;

Grid<float> make_map() {
    Grid<float> map(kSize, kSize);
    unsigned state = 1;
    for (float& value : map.reshaped()) {
        state = state * 1664525u + 1013904223u;
        value = static_cast<float>(state >> 8) * 0x1p-24f;
    }
    return map;
}

const Grid<float>& test_map() {
    static const Grid<float> map = make_map();
    return map;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double memcpy_seconds() {
    static std::vector<float> target(static_cast<std::size_t>(kSize) * kSize);
    const auto start = std::chrono::steady_clock::now();
    std::memcpy(target.data(), test_map().data(), target.size() * sizeof(float));
    benchmark::DoNotOptimize(target.data());
    benchmark::ClobberMemory();
    return seconds_since(start);
}

// Median of interleaved timings, so that a single preemption does not move the ratio.
template <class Work>
void compare(benchmark::State& state, const Work& work) {
    std::vector<double> copies, works;
    for (auto _ : state) {
        copies.push_back(memcpy_seconds());
        const auto start = std::chrono::steady_clock::now();
        work();
        works.push_back(seconds_since(start));
        state.SetIterationTime(works.back());
    }
    const auto median = [](std::vector<double>& values) {
        std::nth_element(values.begin(),
                         values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                         values.end());
        return values[values.size() / 2];
    };
    state.counters["median_ms"] = 1e3 * median(works);
    state.counters["memcpy_ms"] = 1e3 * median(copies);
    state.counters["memcpys"] = median(works) / median(copies);
}

void copy(benchmark::State& state) {
    compare(state, [] { memcpy_seconds(); });
}

void round_trip(benchmark::State& state, Family family, Form form) {
    compare(state, [&] {
        const auto decomposition = decompose(test_map(), family, kLevels, form);
        const Grid<float> back = reconstruct(*decomposition);
        benchmark::DoNotOptimize(back.data());
    });
}

void plain(benchmark::State& state) {
    std::vector<float> map(test_map().data(), test_map().data() + test_map().size());
    std::vector<float> scratch(map.size());
    compare(state, [&] {
        bench::plain_forward(map.data(), scratch.data(), kSize, kLevels);
        bench::plain_inverse(map.data(), scratch.data(), kSize, kLevels);
        benchmark::DoNotOptimize(map.data());
    });
}

constexpr Family kHaar{Family::Kind::cdf, 0, 1};
constexpr Family kLinear{Family::Kind::cdf, 1, 2};
constexpr Family kQuadratic{Family::Kind::cdf, 2, 3};

#define WAVEFOG_BENCHMARK(...) \
    BENCHMARK_CAPTURE(__VA_ARGS__)->UseManualTime()->Unit(benchmark::kMillisecond)->MinTime(1.0)

BENCHMARK(copy)->UseManualTime()->Unit(benchmark::kMillisecond)->Name("memcpy");
WAVEFOG_BENCHMARK(round_trip, haar_1_1, kHaar, Form::wavelet);
WAVEFOG_BENCHMARK(round_trip, linear_2_2, kLinear, Form::wavelet);
BENCHMARK(plain)->UseManualTime()->Unit(benchmark::kMillisecond)->Name("plain_loop_2_2");
WAVEFOG_BENCHMARK(round_trip, quadratic_3_3, kQuadratic, Form::wavelet);
WAVEFOG_BENCHMARK(round_trip, linear_2_2_scaling, kLinear, Form::scaling);

}  // namespace

BENCHMARK_MAIN();
