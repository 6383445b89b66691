#!/usr/bin/env bash
# wavefog on Debian 12, in two commands:
#   ./run.sh demo   installs what is missing, builds, converts a fogmap and renders a foggy valley
#   ./run.sh test   installs what is missing, builds, and runs every test
# Both can be repeated and are quick the second time. The README gives the reason for each package.
# For work on the compact file there is a third:
#   ./run.sh fuzz [SECONDS]   feeds the .wfog coder inputs of libFuzzer's making for so long (60)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

packages=(
    g++ cmake ninja-build
    libeigen3-dev libexpected-dev libfmt-dev nlohmann-json3-dev libcli11-dev
    libopenimageio-dev openimageio-tools libopenexr-dev libzstd-dev
    libglm-dev libgl-dev libosmesa6-dev libegl-dev libassimp-dev
    libmd-dev gnuplot-nox
    doctest-dev libtinyexr-dev libbenchmark-dev
)
fuzz_packages=(clang libclang-rt-14-dev)

# Prints those of the packages named that dpkg does not have.
missing_packages() {
    comm -23 <(printf '%s\n' "$@" | sort) \
        <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
            sed -n 's/^installed //p' | sort)
}

# install_missing PACKAGE...
install_missing() {
    local missing as_root=()
    mapfile -t missing < <(missing_packages "$@")
    if [[ ${#missing[@]} -eq 0 ]]; then return; fi
    if [[ $(id -u) -ne 0 ]]; then as_root=(sudo); fi
    echo "run.sh: installing ${missing[*]}"
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0)
    local install=("${apt[@]}" install -y --no-install-recommends "${missing[@]}")
    # Without package lists, or with old ones, the first try fails at once.
    "${install[@]}" 2>/dev/null || { "${apt[@]}" update && "${install[@]}"; }
}

# build [CMake build arguments]
build() {
    cmake --preset release -Wno-dev --log-level=WARNING
    cmake --build --preset release "$@"
}

demo() {
    install_missing "${packages[@]}"
    build --target wavefog
    mkdir -p out
    local wavefog=build/release/cli/wavefog
    "$wavefog" convert data/weather_coverage_512.png -o out/banks.exr \
        --rect -4200,-4200,4200,4200 --extinction 0.05 --profile exponential:111,17
    "$wavefog" convert data/weather_smooth_512.png -o out/haze.exr --basis quadratic \
        --rect -9000,-9000,9000,9000 --extinction 0.00045 --profile exponential:120,110
    "$wavefog" render data/scenes/valley.json --fog out/banks.exr --fog out/haze.exr \
        -o out/valley.png
    echo "run.sh: the picture is $PWD/out/valley.png"
}

run_tests() {
    install_missing "${packages[@]}"
    build
    ctest --preset release
}

# fuzz SECONDS: both fuzzers side by side. What they find new stays in build/fuzz/corpus for the
# next run; an input that fails, in build/fuzz.
fuzz() {
    local seconds=$1 name failed=0
    install_missing "${packages[@]}" "${fuzz_packages[@]}"
    cmake --preset fuzz -Wno-dev --log-level=WARNING
    cmake --build --preset fuzz
    local -A running=() seeds=(
        [reader]="tests/fuzz/corpus/reader tests/data/wfog"
        [round_trip]="tests/fuzz/corpus/round_trip"
    )
    for name in "${!seeds[@]}"; do
        mkdir -p "build/fuzz/corpus/$name"
        # shellcheck disable=SC2086 # a list of folders
        "build/fuzz/tests/fuzz/wfog_${name}_fuzz" "build/fuzz/corpus/$name" ${seeds[$name]} \
            -max_total_time="$seconds" -max_len=8192 -timeout=120 -rss_limit_mb=2048 \
            -artifact_prefix="build/fuzz/$name-" >"build/fuzz/$name.log" 2>&1 &
        running[$name]=$!
    done
    for name in "${!seeds[@]}"; do
        if wait "${running[$name]}"; then
            echo "run.sh: fuzzing the .wfog $name: $(tail -n 1 "build/fuzz/$name.log"), no failure"
        else
            tail -n 60 "build/fuzz/$name.log"
            echo "run.sh: fuzzing the .wfog $name failed: the log is build/fuzz/$name.log"
            failed=1
        fi
    done
    return "$failed"
}

case "${1:-}" in
    demo) demo ;;
    test) run_tests ;;
    fuzz) fuzz "${2:-60}" ;;
    *)
        sed -n '2,7s/^# \?//p' "${BASH_SOURCE[0]}" >&2
        exit 2
        ;;
esac
