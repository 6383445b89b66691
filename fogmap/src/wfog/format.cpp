#include "format.h"

#include <fmt/format.h>
#include <zstd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "../crc32.h"

namespace wavefog::wfog {

namespace {

constexpr std::uint8_t kMagic[4] = {'W', 'F', 'O', 'G'};
// An upper-case type must be understood, a lower-case one may be skipped.
constexpr unsigned kHead = 'F', kStream = 'S';
constexpr int kMaxFogLevels = 30;
constexpr std::uint64_t kMaxWindKeys = 65536;

enum Flags : unsigned {
    has_rect = 1,
    has_extinction = 2,
    has_wind = 4,
    profile_shift = 3,  // two bits: Profile::Kind
    has_coefficients = 32,
    has_coarser_bounds = 64,
    has_wind_keys = 128,
};

std::uint32_t checksum(View chunk) {
    return ~detail::update_crc(0xffffffffu, chunk.data(), chunk.size());
}

void write_chunk(Writer& to, unsigned type, View payload) {
    const std::size_t begin = to.bytes.size();
    to.byte(type);
    to.length(payload.size());
    to.append(payload);
    to.fixed(checksum(View(to.bytes).subspan(begin)), 4);
}

bool default_rect(const Fog& fog) {
    return fog.rect ==
           Rect{0, 0, double(fog.decomposition.width), double(fog.decomposition.height)};
}

/// The floats' bits, as differences of neighbours, by zstd.
void write_table(Writer& w, const std::vector<float>& values) {
    Writer plain;
    std::int64_t last = 0;
    for (const float value : values) {
        const std::int64_t bits = *Scale{Scale::Kind::float_bits}.integer(value);
        plain.signed_length(bits - last);
        last = bits;
    }
    Bytes packed(ZSTD_compressBound(plain.bytes.size()));
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), plain.bytes.data(),
                                           plain.bytes.size(), ZSTD_maxCLevel());
    if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));
    w.length(values.size());
    w.length(plain.bytes.size());
    w.length(size);
    w.append(View(packed).first(size));
}

bool read_table(Reader& r, std::vector<float>& values) {
    const std::uint64_t count = r.length(), plain_size = r.length();
    const View packed = r.take(r.length());
    if (r.failed() || count < 1 || count > kMaxTable || plain_size > 10 * count) return false;
    Bytes plain(static_cast<std::size_t>(plain_size));
    if (ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size()) != plain.size())
        return false;
    Reader differences(plain);
    std::int64_t bits = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::int64_t difference = differences.signed_length();
        if (std::abs(difference) > (std::int64_t(1) << 33)) return false;
        bits += difference;
        if (bits != static_cast<std::int32_t>(bits)) return false;
        const float value = Scale{Scale::Kind::float_bits}.density(static_cast<std::int32_t>(bits));
        if (!std::isfinite(value)) return false;
        values.push_back(value);
    }
    return !differences.failed() && differences.left() == 0;
}

Bytes write_head(const Head& head) {
    const Fog& fog = head.fog;
    const Decomposition<float>& d = fog.decomposition;
    Writer w;
    w.length(static_cast<unsigned>(d.width));
    w.length(static_cast<unsigned>(d.height));
    w.byte(static_cast<unsigned>(d.family.degree) | (d.form == Form::scaling ? 16u : 0u) |
           (d.boundary == Boundary::repeat ? 32u : 0u));
    w.byte(static_cast<unsigned>(d.family.kind) << 6 |
           static_cast<unsigned>(d.family.dual_moments));
    w.byte(static_cast<unsigned>(head.levels));
    unsigned flags = static_cast<unsigned>(fog.profile.kind) << profile_shift;
    if (!default_rect(fog)) flags |= has_rect;
    if (fog.extinction != 1) flags |= has_extinction;
    if (!fog.wind.calm()) flags |= fog.wind.constant() ? has_wind : has_wind_keys;
    if (head.content == Content::coefficients) flags |= has_coefficients;
    if (!head.bounds.coarser.empty()) flags |= has_coarser_bounds;
    w.byte(flags);
    if (flags & has_rect)
        for (const double side : {fog.rect.x0, fog.rect.z0, fog.rect.x1, fog.rect.z1})
            w.number(side);
    if (flags & has_extinction) w.number(fog.extinction);
    if (flags & has_wind) w.number(fog.wind.keys[0].x), w.number(fog.wind.keys[0].z);
    if (flags & has_wind_keys) {
        w.length(fog.wind.keys.size());
        for (const Wind::Key& key : fog.wind.keys)
            w.number(key.seconds), w.number(key.x), w.number(key.z);
    }
    const Profile& p = fog.profile;
    if (p.kind == Profile::Kind::slab) w.number(p.bottom), w.number(p.top);
    if (p.kind == Profile::Kind::exponential) w.number(p.base), w.number(p.scale);
    if (p.kind == Profile::Kind::linear) w.number(p.base), w.number(p.top);

    w.byte(static_cast<unsigned>(head.scale.kind));
    if (head.scale.kind == Scale::Kind::ratio) w.length(head.scale.divisor);
    if (head.scale.kind == Scale::Kind::step || head.scale.kind == Scale::Kind::companded)
        w.number(head.scale.step);
    if (head.scale.kind == Scale::Kind::companded) w.number(head.scale.growth);
    if (head.scale.kind == Scale::Kind::float_bits) w.byte(head.scale.shift);
    if (head.scale.kind == Scale::Kind::table) write_table(w, head.scale.values);
    w.length(static_cast<std::uint64_t>(head.bounds.finest));
    w.byte(static_cast<unsigned>(head.tile_bits));
    w.byte(static_cast<unsigned>(head.stream_levels));
    for (const std::int64_t bound : head.bounds.coarser)
        w.length(static_cast<std::uint64_t>(bound));
    w.fixed(std::bit_cast<std::uint32_t>(head.max_error), 4);
    return std::move(w.bytes);
}

tl::unexpected<Error> damaged(const char* what) {
    return data_error(fmt::format("damaged: {}; get the file again", what));
}

Result<void> read_fog(Reader& r, Head& head, bool& has_coarser) {
    Fog& fog = head.fog;
    Decomposition<float>& d = fog.decomposition;
    const std::uint64_t width = r.length(), height = r.length();
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
        return damaged("the map's size is impossible");
    d.width = static_cast<int>(width);
    d.height = static_cast<int>(height);
    const unsigned basis = r.byte(), family = r.byte();
    if (basis > 63 || family >> 6 > 2) return damaged("no such basis or family");
    d.form = basis & 16 ? Form::scaling : Form::wavelet;
    d.boundary = basis & 32 ? Boundary::repeat : Boundary::zero;
    d.family = {static_cast<Family::Kind>(family >> 6), static_cast<int>(basis & 15),
                static_cast<int>(family & 63)};
    if (const auto known = parse_family(d.family.name(), d.family.degree);
        !known || *known != d.family)
        return damaged("no such family");
    head.levels = static_cast<int>(r.byte());
    if (head.levels > kMaxFogLevels) return damaged("too many levels");
    const unsigned flags = r.byte();
    if (flags & has_wind && flags & has_wind_keys) return damaged("it has two winds");
    fog.rect = {0, 0, double(d.width), double(d.height)};
    if (flags & has_rect)
        for (double* side : {&fog.rect.x0, &fog.rect.z0, &fog.rect.x1, &fog.rect.z1})
            *side = r.number();
    if (flags & has_extinction) fog.extinction = r.number();
    if (flags & has_wind) {
        const double x = r.number();
        fog.wind = {x, r.number()};
    }
    if (flags & has_wind_keys) {
        const std::uint64_t count = r.length();
        if (count < 1 || count > kMaxWindKeys || count > r.left() / 24)
            return damaged("the wind's keys end too soon");
        fog.wind.keys.resize(static_cast<std::size_t>(count));
        for (Wind::Key& key : fog.wind.keys)
            for (double* part : {&key.seconds, &key.x, &key.z}) *part = r.number();
    }
    Profile& p = fog.profile;
    p.kind = static_cast<Profile::Kind>(flags >> profile_shift & 3u);
    if (p.kind == Profile::Kind::slab) p.bottom = r.number(), p.top = r.number();
    if (p.kind == Profile::Kind::exponential) p.base = r.number(), p.scale = r.number();
    if (p.kind == Profile::Kind::linear) p.base = r.number(), p.top = r.number();
    head.content = flags & has_coefficients ? Content::coefficients : Content::pixels;
    has_coarser = (flags & has_coarser_bounds) != 0;
    if (has_coarser && head.content == Content::coefficients)
        return damaged("coefficients have no bounds");
    return {};
}

Result<Head> read_head(View payload) {
    Head head;
    Reader r(payload);
    bool has_coarser = false;
    if (auto ok = read_fog(r, head, has_coarser); !ok) return tl::unexpected(ok.error());
    const unsigned kind = r.byte();
    if (kind > static_cast<unsigned>(Scale::Kind::companded))
        return data_error(fmt::format(
            "has densities on a scale {} that this program does not know; use a newer one", kind));
    head.scale.kind = static_cast<Scale::Kind>(kind);
    if (head.scale.kind == Scale::Kind::ratio) {
        const std::uint64_t divisor = r.length();
        if (divisor < 1 || divisor > 0xffffffffu) return damaged("the divisor is impossible");
        head.scale.divisor = static_cast<std::uint32_t>(divisor);
    }
    const bool companded = head.scale.kind == Scale::Kind::companded;
    if (head.scale.kind == Scale::Kind::step || companded) {
        head.scale.step = r.number();
        if (!(head.scale.step > 0) || !std::isfinite(head.scale.step))
            return damaged("the step is impossible");
    }
    if (companded) {
        // So densities rise with their integers; those that overflow are refused as they come.
        head.scale.growth = r.number();
        if (!(head.scale.growth > 0 && head.scale.growth <= 1))
            return damaged("the growth of the steps is impossible");
    }
    if (head.scale.kind == Scale::Kind::float_bits) {
        head.scale.shift = r.byte();
        if (head.scale.shift > 31) return damaged("the shift is impossible");
    }
    if (head.scale.kind == Scale::Kind::table && !read_table(r, head.scale.values))
        return damaged("the table of densities is impossible");
    const std::uint64_t bound = r.length();
    const unsigned tile_bits = r.byte(), stream_levels = r.byte();
    bool bounds_fit = bound <= (1u << 30);
    for (unsigned l = 0; has_coarser && l < stream_levels && !r.failed(); ++l) {
        const std::uint64_t coarser = r.length();
        bounds_fit = bounds_fit && coarser <= bound;
        head.bounds.coarser.push_back(static_cast<std::int64_t>(coarser));
    }
    head.max_error = std::bit_cast<float>(static_cast<std::uint32_t>(r.fixed(4)));
    if (r.failed() || r.left() != 0) return damaged("the head has a wrong length");
    if (!bounds_fit || tile_bits < kMinTileBits || tile_bits > kMaxTileBits ||
        stream_levels > tile_bits)
        return damaged("bound, tiles or levels are impossible");
    head.bounds.finest = static_cast<std::int64_t>(bound);
    head.tile_bits = static_cast<int>(tile_bits);
    head.stream_levels = static_cast<int>(stream_levels);
    return head;
}

}  // namespace

Bytes write_chunks(const Head& head, const std::vector<Bytes>& streams) {
    Writer w;
    w.append(kMagic);
    w.byte(kVersion);
    write_chunk(w, kHead, write_head(head));
    for (const Bytes& stream : streams) write_chunk(w, kStream, stream);
    return std::move(w.bytes);
}

Result<Chunks> read_chunks(View bytes, bool partial) {
    Reader r(bytes);
    const View magic = r.take(sizeof kMagic);
    if (r.failed() || !std::equal(magic.begin(), magic.end(), kMagic))
        return data_error("is no .wfog file; convert a picture to one");
    const unsigned version = r.byte();
    if (r.failed()) return damaged("it ends after the magic");
    if (version == 0) return damaged("its format version is 0, which does not exist");
    if (version != kVersion)
        return data_error(fmt::format(
            "has format version {}; this program reads {}: use a newer one", version, kVersion));
    Chunks chunks;
    bool has_head = false;
    while (r.left() > 0) {
        const View rest = bytes.subspan(bytes.size() - r.left());
        const unsigned type = r.byte();
        const View payload = r.take(r.length());
        const std::size_t size = rest.size() - r.left();
        const std::uint64_t stored = r.fixed(4);
        if (r.failed()) {
            if (has_head && static_cast<int>(chunks.streams.size()) == chunks.expected())
                return damaged(
                    fmt::format("{} bytes after its last level are no chunk", rest.size()).c_str());
            chunks.truncated = true;
            break;
        }
        if (stored != checksum(rest.first(size)))
            return damaged(
                fmt::format("a chunk's checksum is wrong, {} bytes from the end", rest.size())
                    .c_str());
        const bool is_letter = (type >= 'a' && type <= 'z') || (type >= 'A' && type <= 'Z');
        if (!is_letter) return damaged("a chunk has no type");
        if (!has_head && type != kHead) return damaged("it does not start with its head");
        if (type == kHead) {
            if (has_head) return damaged("it has two heads");
            auto head = read_head(payload);
            if (!head) return tl::unexpected(head.error());
            chunks.head = std::move(*head);
            has_head = true;
        } else if (type == kStream) {
            if (static_cast<int>(chunks.streams.size()) == chunks.expected())
                return damaged("it has more streams than levels");
            chunks.streams.push_back(payload);
        } else if (type <= 'Z') {
            return data_error(
                fmt::format("needs a feature '{}' that this program does not know; use a newer one",
                            static_cast<char>(type)));
        }
    }
    chunks.truncated =
        chunks.truncated || static_cast<int>(chunks.streams.size()) < chunks.expected();
    if (!has_head || chunks.streams.empty() || (chunks.truncated && !partial))
        return data_error(fmt::format("is truncated: {} of {} levels are whole; get the file again",
                                      chunks.streams.size(),
                                      has_head ? std::to_string(chunks.expected()) : "its"));
    return chunks;
}

}  // namespace wavefog::wfog
