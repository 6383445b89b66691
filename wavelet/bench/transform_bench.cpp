// Forward plus inverse transform of a 2048 x 2048 float map on one core, 5 levels, beside memcpy of
// the same bytes. Rules: every case runs in this one program; memcpy is timed before each run of a
// case, so that another load on the machine hits both; counter "memcpys" = best time of the case /
// best time of memcpy, "memcpys_median" the same of medians. "reused" writes into the objects of
// the run before, as memcpy does (a map that changes every frame); "fresh" allocates its results
// and pays for their page faults.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
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

// CPU time of this thread, system calls and page faults included: all work is on one core, and
// waiting for a busy machine is not work.
double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double memcpy_seconds() {
    static std::vector<float> target(static_cast<std::size_t>(kSize) * kSize);
    const double start = cpu_seconds();
    std::memcpy(target.data(), test_map().data(), target.size() * sizeof(float));
    benchmark::DoNotOptimize(target.data());
    benchmark::ClobberMemory();
    return cpu_seconds() - start;
}

// Times memcpy and `work` in turn.
template <class Work>
void compare(benchmark::State& state, const Work& work) {
    std::vector<double> copies, works;
    for (auto _ : state) {
        copies.push_back(memcpy_seconds());
        const double start = cpu_seconds();
        work();
        works.push_back(cpu_seconds() - start);
        state.SetIterationTime(works.back());
    }
    std::sort(copies.begin(), copies.end());
    std::sort(works.begin(), works.end());
    const std::size_t middle = works.size() / 2;
    state.counters["best_ms"] = 1e3 * works.front();
    state.counters["memcpy_ms"] = 1e3 * copies.front();
    state.counters["memcpys"] = works.front() / copies.front();
    state.counters["memcpys_median"] = works[middle] / copies[middle];
}

void copy(benchmark::State& state) {
    compare(state, [] { memcpy_seconds(); });
}

void reused(benchmark::State& state, Family family, Form form) {
    Decomposition<float> decomposition;
    Grid<float> back;
    compare(state, [&] {
        benchmark::DoNotOptimize(
            decompose_into(test_map(), family, kLevels, form, Boundary::zero, decomposition));
        reconstruct_into(decomposition, back);
        benchmark::DoNotOptimize(back.data());
    });
}

void fresh(benchmark::State& state, Family family, Form form) {
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

void measured(benchmark::internal::Benchmark* benchmark) {
    benchmark->UseManualTime()->Unit(benchmark::kMillisecond)->MinTime(2.0);
}

BENCHMARK(copy)->Name("memcpy")->Apply(measured);
BENCHMARK_CAPTURE(reused, haar_1_1, kHaar, Form::wavelet)->Apply(measured);
BENCHMARK_CAPTURE(reused, linear_2_2, kLinear, Form::wavelet)->Apply(measured);
BENCHMARK_CAPTURE(fresh, haar_1_1, kHaar, Form::wavelet)->Apply(measured);
BENCHMARK_CAPTURE(fresh, linear_2_2, kLinear, Form::wavelet)->Apply(measured);
BENCHMARK(plain)->Name("plain_loop_2_2")->Apply(measured);
BENCHMARK_CAPTURE(fresh, quadratic_3_3, kQuadratic, Form::wavelet)->Apply(measured);
BENCHMARK_CAPTURE(fresh, linear_2_2_scaling, kLinear, Form::scaling)->Apply(measured);

}  // namespace

BENCHMARK_MAIN();
