#!/usr/bin/env bash
# wavefog on Debian 12, in two commands:
#   ./run.sh demo   installs what is missing, builds, converts a fogmap and renders a foggy valley
#   ./run.sh test   installs what is missing, builds, and runs every test
# Both can be repeated and are quick the second time. The README gives the reason for each package.
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

# Prints those of the packages that dpkg does not have.
missing_packages() {
    comm -23 <(printf '%s\n' "${packages[@]}" | sort) \
        <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null |
            sed -n 's/^installed //p' | sort)
}

install_missing() {
    local missing as_root=()
    mapfile -t missing < <(missing_packages)
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
    install_missing
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
    install_missing
    build
    ctest --preset release
}

case "${1:-}" in
    demo) demo ;;
    test) run_tests ;;
    *)
        sed -n '2,5s/^# \?//p' "${BASH_SOURCE[0]}" >&2
        exit 2
        ;;
esac
