#include "wavefog/fogmap/wfog.h"

#include <fmt/format.h>

#include <istream>
#include <iterator>
#include <new>
#include <ostream>

#include "decoder.h"
#include "encoder.h"

namespace wavefog {

namespace {

template <class Function>
auto guarded(Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const std::bad_alloc&) {
        return data_error("not enough memory; use a smaller map");
    } catch (const std::exception& error) {
        return data_error(fmt::format("cannot be used ({})", error.what()));
    }
}

}  // namespace

Result<EncodedFog> encode_wfog(const Fog& fog, const WfogOptions& options, const Grid<float>* map) {
    return guarded([&] { return wfog::encode(fog, options, map); });
}

Result<DecodedFog> decode_wfog(std::span<const std::uint8_t> bytes, const WfogLimits& limits) {
    return guarded([&] { return wfog::decode(bytes, limits); });
}

Result<DecodedFog> decode_wfog(std::istream& stream, const WfogLimits& limits) {
    return guarded([&]() -> Result<DecodedFog> {
        const std::vector<char> read{std::istreambuf_iterator<char>(stream), {}};
        if (stream.bad()) return data_error("cannot be read");
        return wfog::decode({reinterpret_cast<const std::uint8_t*>(read.data()), read.size()},
                            limits);
    });
}

Result<WfogReport> encode_wfog(std::ostream& stream, const Fog& fog, const WfogOptions& options,
                               const Grid<float>* map) {
    const auto encoded = encode_wfog(fog, options, map);
    if (!encoded) return tl::unexpected(encoded.error());
    stream.write(reinterpret_cast<const char*>(encoded->bytes.data()),
                 static_cast<std::streamsize>(encoded->bytes.size()));
    if (!stream) return data_error("cannot be written; is the disk full?");
    return encoded->report;
}

}  // namespace wavefog
