// --preset compression: .wfog files beside image codecs, at the same promised error.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/results.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog::cli {

/// A map as integers, so that every codec is asked for the same.
struct CodecMap {
    std::string name;
    Grid<float> densities;  ///< in [0,1] for integer pictures
    double full_scale = 1;  ///< of densities
    int steps = 0;          ///< of an integer picture: 255 or 65535; 0: floats
};

/// What a codec made of one map at one error.
struct CodecRun {
    std::size_t bytes = 0;
    double encode_s = 0, decode_s = 0;
    /// Longest less shortest time over the median; 0 of a single run.
    double encode_spread = 0, decode_spread = 0;
    std::optional<double> max_error;  ///< in 1/255 of full scale
    std::optional<double> psnr;       ///< dB of full scale; empty if nothing was lost
    Grid<float> densities;            ///< as decoded
};

/// Indices of the values after prequantisation: steps of 2 E, integers 2 E + 1
/// (compression.md 2.1).
struct Prequantised {
    Grid<std::uint16_t> indices;
    Grid<float> densities;  ///< as they would be decoded
    int largest = 0;
};
/// `error` in 1/255 of full scale, 0: none (empty for floats, and where indices need over 16 bits).
std::optional<Prequantised> prequantise(const CodecMap& map, double error);

/// Codecs of other projects that are installed, as they stand in the tables. They code the indices
/// of prequantise() without loss; zfp codes the map itself, with a bound of its own, and a decoder
/// rounds to whole steps of a picture of integers.
inline constexpr const char* zfp_name = "zfp";
std::vector<std::string> installed_peers();
Result<CodecRun> run_peer(const std::string& peer, const CodecMap& map, double error,
                          const Prequantised& input, const std::filesystem::path& folder);

/// Measures every map (pictures by name, and three that are made up) with every codec at 0, 1, 2
/// and 4/255. A peer that fails is told in Results::skipped.
Result<void> study_compression(const std::vector<std::filesystem::path>& pictures,
                               Results& results);

/// Geometric means over the maps that every codec could code; then each map's bits.
std::string compression_text(const Facts& runs, bool markdown);

/// Bits against PSNR, and bits against speed.
std::vector<Figure> compression_figures(const Facts& runs);

}  // namespace wavefog::cli
